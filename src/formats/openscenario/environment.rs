//! Time of day and weather.

use std::fmt::Write as _;

use crate::xml_text::number;
use scene::{Conditions, TimeOfDay, Weather};

/// The environment as an action of the start.
pub(super) fn write(out: &mut String, conditions: &Conditions) {
    let time = match conditions.time {
        TimeOfDay::Dawn => "06:00:00",
        TimeOfDay::Day => "12:00:00",
        TimeOfDay::Dusk => "20:00:00",
        TimeOfDay::Night => "23:00:00",
    };
    // Share of the sky in eighths, kind of precipitation and millimetres an hour.
    let (clouds, falls, intensity) = match conditions.weather {
        Weather::Clear => ("twoOktas", "dry", 0.0),
        Weather::Overcast | Weather::Fog => ("eightOktas", "dry", 0.0),
        Weather::Sandstorm => ("fourOktas", "dry", 0.0),
        Weather::Rain => ("eightOktas", "rain", 5.0),
        Weather::Snow => ("eightOktas", "snow", 2.0),
    };
    let wetness = match conditions.wetness {
        w if w < 0.1 => "dry",
        w if w < 0.5 => "moist",
        _ => "wetWithPuddles",
    };
    // Dry asphalt is 1; wet asphalt has about seven tenths of its grip, snow about three.
    let grip = match conditions.weather {
        Weather::Snow => 0.3,
        _ => 1.0 - 0.3 * conditions.wetness,
    };
    let _ = writeln!(
        out,
        "        <GlobalAction>\n          <EnvironmentAction>\n            <Environment name=\"{} {}\">\n              \
         <TimeOfDay animation=\"false\" dateTime=\"2026-06-21T{time}\"/>\n              \
         <Weather fractionalCloudCover=\"{clouds}\">",
        conditions.time.name(),
        conditions.weather.name(),
    );
    if let Some(sun) = conditions.sun {
        // From north over east; x of the world frame is east.
        let azimuth = (90.0 - sun.azimuth_deg).rem_euclid(360.0).to_radians();
        let elevation = sun.elevation_deg.to_radians();
        // Lux: the sun from straight above under a clear sky, a seventh of it through clouds; the full moon.
        let from_above = match (conditions.time, conditions.weather) {
            (TimeOfDay::Night, _) => 0.25,
            (_, Weather::Clear) => 100_000.0,
            _ => 15_000.0,
        };
        let _ = writeln!(
            out,
            "                <Sun azimuth=\"{}\" elevation=\"{}\" illuminance=\"{}\"/>",
            number(azimuth),
            number(elevation),
            number(from_above * elevation.sin())
        );
    }
    let _ = writeln!(
        out,
        "                <Fog visualRange=\"{}\"/>\n                <Precipitation precipitationType=\"{falls}\" \
         precipitationIntensity=\"{}\"/>\n              </Weather>\n              \
         <RoadCondition frictionScaleFactor=\"{}\" wetness=\"{wetness}\"/>\n            </Environment>\n          \
         </EnvironmentAction>\n        </GlobalAction>",
        number(conditions.visibility_m),
        number(intensity),
        number(grip),
    );
}
