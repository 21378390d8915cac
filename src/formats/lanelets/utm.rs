//! Geographic coordinates to metres: the Universal Transverse Mercator projection on the ellipsoid of WGS 84 (Krüger 1912, series to
//! the fourth order as in Karney 2011; exact to a micrometre within a zone).

use glam::DVec2;

/// Largest axis of the ellipsoid, m, and its flattening.
const AXIS_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Scale on the central meridian.
const SCALE: f64 = 0.9996;
/// Easting of the central meridian, m.
const EASTING_M: f64 = 500_000.0;
/// Northing of the equator on the southern half of the earth, m.
const SOUTH_M: f64 = 10_000_000.0;

/// A zone: its central meridian, and which half of the earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zone {
    /// 1 to 60.
    pub number: u8,
    pub south: bool,
}

impl Zone {
    /// The zone of a place, degrees; the exceptions of Norway and Svalbard are left aside. `None` beyond 84 degrees of
    /// latitude, beyond 180 of longitude, and for numbers that are not finite.
    pub fn from_degrees(latitude_deg: f64, longitude_deg: f64) -> Option<Self> {
        let sound = (-84.0..=84.0).contains(&latitude_deg) && (-180.0..=180.0).contains(&longitude_deg);
        sound.then(|| Self {
            number: (((longitude_deg + 180.0) / 6.0).floor() as u8).min(59) + 1,
            south: latitude_deg < 0.0,
        })
    }

    /// Easting and northing of a place, m.
    pub fn project(self, latitude_deg: f64, longitude_deg: f64) -> DVec2 {
        let n = FLATTENING / (2.0 - FLATTENING);
        let (n2, n3, n4) = (n * n, n.powi(3), n.powi(4));
        let rectifying = AXIS_M / (1.0 + n) * (1.0 + n2 / 4.0 + n4 / 64.0);
        let alpha = [
            n / 2.0 - 2.0 / 3.0 * n2 + 5.0 / 16.0 * n3 + 41.0 / 180.0 * n4,
            13.0 / 48.0 * n2 - 3.0 / 5.0 * n3 + 557.0 / 1440.0 * n4,
            61.0 / 240.0 * n3 - 103.0 / 140.0 * n4,
            49_561.0 / 161_280.0 * n4,
        ];
        let central = f64::from(self.number) * 6.0 - 183.0;
        let lambda = (longitude_deg - central).to_radians();
        let e = 2.0 * n.sqrt() / (1.0 + n);
        let sine = latitude_deg.to_radians().sin();
        let t = (sine.atanh() - e * (e * sine).atanh()).sinh();
        let xi = t.atan2(lambda.cos());
        let eta = (lambda.sin() / t.hypot(lambda.cos())).asinh();
        let (mut x, mut y) = (xi, eta);
        for (j, a) in alpha.iter().enumerate() {
            let k = 2.0 * (j + 1) as f64;
            x += a * (k * xi).sin() * (k * eta).cosh();
            y += a * (k * xi).cos() * (k * eta).sinh();
        }
        let north = SCALE * rectifying * x + if self.south { SOUTH_M } else { 0.0 };
        DVec2::new(EASTING_M + SCALE * rectifying * y, north)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computed with pyproj 3.7.2 (PROJ 9.5.1).
    #[test]
    fn places_are_where_proj_has_them() {
        for (latitude, longitude, zone, east, north) in PLACES {
            let found = Zone::from_degrees(latitude, longitude).expect("a place");
            assert_eq!(found.number, zone);
            let p = found.project(latitude, longitude);
            assert!(
                p.distance(DVec2::new(east, north)) < 1e-4,
                "{latitude} {longitude}: {p}"
            );
        }
        assert!(Zone::from_degrees(f64::NAN, 0.0).is_none() && Zone::from_degrees(85.0, 0.0).is_none());
        assert!(Zone::from_degrees(0.0, 180.0).is_some_and(|z| z.number == 60));
    }

    const PLACES: [(f64, f64, u8, f64, f64); 6] = [
        (
            49.003_456_543_51,
            8.424_275_907_07,
            32,
            457_893.098_21,
            5_427_999.699_30,
        ),
        (
            35.903_273_027_357_48,
            139.933_661_610_804_28,
            54,
            403_774.481_40,
            3_973_745.238_30,
        ),
        (-33.8688, 151.2093, 56, 334_368.633_65, 6_250_948.345_39),
        (1.3521, 103.8198, 48, 368_700.272_37, 149_479.866_29),
        (64.1466, -21.9426, 27, 454_138.376_52, 7_113_689.868_97),
        (0.0, -75.5, 18, 444_361.807_56, 0.0),
    ];
}
