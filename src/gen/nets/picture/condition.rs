//! Condition of the transformer for a frame: classes, depths and facings of every pixel, light and weather, cameras.

use super::RingSize;
use crate::encoder::{EncoderLevel, PIECE, levels, steps};
use crate::picture::PictureDitConfig;
use crate::{ModelError, check_finite, check_length};
use nn::Ops;
use nn::map::FeatureMap;
use nn::weights::{WeightFile, WeightsError};

/// Number of render ids: 0 nothing, 1 to 16 classes, 17 to 19 paint.
const CLASSES: usize = 20;
/// Number of facings: 0 none, else 1 + sixteenths of a turn.
const FACINGS: usize = 17;
/// Flag of a facing where another box begins.
pub const EDGE: u8 = 0x80;
/// Numbers that encode a depth.
const DEPTHS: usize = 4;
/// Least depth whose logarithm is encoded, m; smaller depths count as this in it.
const NEAREST_M: f32 = 0.3;
/// Number of times of day that can be given.
pub const TIMES: usize = 4;
/// Number of weathers that can be given.
pub const WEATHERS: usize = 6;
/// Numbers of a camera.
pub const CAMERA_NUMBERS: usize = 7;

/// A condition: what a frame's pictures shall show. Arrays of pixels are `[view][height][width]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Cameras and the size of their pictures.
    pub size: RingSize,
    /// Render id of what a pixel shows, 0 to 19; 0 is nothing.
    pub classes: Vec<u8>,
    /// Its depth along the optical axis, m; 0 where there is nothing.
    pub depth_m: Vec<f32>,
    /// Heading at a box's pixels: 1 + how it faces in sixteenths of a turn, and [`EDGE`]; 0 elsewhere.
    pub facings: Vec<u8>,
    /// Time of day, below [`TIMES`]; `None` if it is not given.
    pub time: Option<usize>,
    /// Weather, below [`WEATHERS`]; `None` if it is not given.
    pub weather: Option<usize>,
    /// Numbers of every camera: direction towards the light in the optical frame (3), third row of the rotation from
    /// the camera to the map (3), focal length / width of the picture.
    pub cameras: Vec<[f32; CAMERA_NUMBERS]>,
}

impl Condition {
    /// Fails unless all sizes fit, ids are known and numbers finite.
    fn check(&self) -> Result<(), ModelError> {
        let (views, pixels) = (self.size.views(), self.size.view_pixels() * self.size.views());
        check_length("classes", self.classes.len(), pixels)?;
        check_length("depths", self.depth_m.len(), pixels)?;
        check_length("facings", self.facings.len(), pixels)?;
        check_length("cameras", self.cameras.len(), views)?;
        check_finite("depth", &self.depth_m)?;
        check_finite("camera number", self.cameras.as_flattened())?;
        let refused = |what, found: Option<usize>, expected| match found {
            None => Ok(()),
            Some(found) => Err(ModelError::OutOfRange {
                what,
                found,
                expected,
            }),
        };
        let most = |values: &[u8], flags: u8, below: usize| {
            let plain = values.iter().map(|v| usize::from(v & !flags));
            plain.max().filter(|found| *found >= below)
        };
        refused("largest class id", most(&self.classes, 0, CLASSES), "0 to 19")?;
        refused(
            "largest facing",
            most(&self.facings, EDGE, FACINGS),
            "0 to 16 and the flag",
        )?;
        refused("time of day", self.time.filter(|t| *t >= TIMES), "0 to 3")?;
        refused("weather", self.weather.filter(|w| *w >= WEATHERS), "0 to 5")
    }
}

/// Encoded condition: depends on neither noise nor step, so it is made once per frame. `T` is the backend's tensor.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedCondition<T = FeatureMap> {
    /// Cameras and the size of their pictures.
    pub size: RingSize,
    /// Encoded pixels of every view, one place per cell.
    pub(super) cells: Vec<T>,
    /// Encoded time of day, weather and camera of every view, one place.
    pub(super) light: Vec<T>,
    /// Positions of tokens, one place each.
    pub(super) positions: T,
}

impl<B: Ops> super::PictureDit<B> {
    /// Encodes a condition. Errors if its sizes do not fit, an id is unknown or a number is not finite.
    pub fn tell(&self, condition: &Condition) -> Result<EncodedCondition<B::Tensor>, ModelError> {
        condition.check()?;
        let (ops, size) = (&self.ops, condition.size);
        let part = |view: usize| view * size.view_pixels()..(view + 1) * size.view_pixels();
        let cells = super::dit::each_view(size, |view| {
            let (classes, facings) = (&condition.classes[part(view)], &condition.facings[part(view)]);
            self.teller
                .cells(ops, classes, &condition.depth_m[part(view)], facings, size)
        })?;
        let light = self.light.of(ops, condition)?;
        Ok(EncodedCondition {
            size,
            cells,
            light,
            positions: self.positions(size)?,
        })
    }

    /// The encoded condition without classes, depths and facings, for guidance; time of day, weather and cameras stay.
    pub fn silent(
        &self,
        told: &EncodedCondition<B::Tensor>,
    ) -> Result<EncodedCondition<B::Tensor>, ModelError> {
        let (size, pixels) = (told.size, told.size.view_pixels());
        let (nothing, no_depth) = (vec![0; pixels], vec![0.0; pixels]);
        // All views get the same.
        let cells = self
            .teller
            .cells(&self.ops, &nothing, &no_depth, &nothing, size)?;
        Ok(EncodedCondition {
            cells: vec![cells; size.views()],
            ..told.clone()
        })
    }
}

/// Encoder of the pixels of a view to cells.
pub(super) struct Teller<B: Ops> {
    table: B::Table, // classes, then facings, then the edge
    depth: B::Linear,
    down: Vec<B::Linear>,
    levels: Vec<EncoderLevel<B>>,
}

impl<B: Ops> Teller<B> {
    /// Takes the tensors `told.*`.
    pub(super) fn new(
        ops: &B,
        w: &mut WeightFile<'_>,
        config: &PictureDitConfig,
    ) -> Result<Self, WeightsError> {
        let ([pixel, two, four], eight) = (config.told, config.cells);
        let table = [
            w.take("told.classes.weight", &[CLASSES, pixel])?,
            w.take("told.facings.weight", &[FACINGS, pixel])?,
            w.take("told.edge", &[pixel])?,
        ];
        let sizes = vec![[4 * pixel, two], [4 * two, four], [4 * four, eight]];
        Ok(Self {
            table: ops
                .table_from(table.concat(), pixel)
                .map_err(|e| w.backend_error(e))?,
            depth: ops.linear_without_bias(w, "told.depth", [DEPTHS, pixel])?,
            down: steps(ops, w, "told.down", sizes)?,
            levels: levels(
                ops,
                w,
                "told.levels",
                &[two, four, eight],
                &[vec![3], vec![3, 3], vec![3]],
            )?,
        })
    }

    /// Encodes the pixels of one view.
    fn cells(
        &self,
        ops: &B,
        classes: &[u8],
        depth_m: &[f32],
        facings: &[u8],
        size: RingSize,
    ) -> Result<B::Tensor, ModelError> {
        let [rows, columns] = size.pixels();
        let depths = ops.upload(FeatureMap {
            data: depth_m.iter().flat_map(|d| depth_numbers(*d)).collect(),
            rows,
            columns,
            width: DEPTHS,
        })?;
        let depths = ops.apply(&self.depth, &depths, PIECE)?;
        let mut map = ops.bag(&self.table, depths, |row, column| {
            let at = row * columns + column;
            let edge = (facings[at] & EDGE != 0).then_some(CLASSES + FACINGS);
            let plain = [
                usize::from(classes[at]),
                CLASSES + usize::from(facings[at] & !EDGE),
            ];
            plain.into_iter().chain(edge)
        })?;
        for (down, level) in self.down.iter().zip(&self.levels) {
            map = level.apply(ops, ops.apply(down, &ops.fold(&map)?, PIECE)?)?;
        }
        Ok(map)
    }
}

/// Encoded depth: whether there is a surface, the logarithm of its depth, its nearness, and a sine with a period of a
/// metre that fades with depth; all 0 where there is nothing.
fn depth_numbers(depth_m: f32) -> [f32; DEPTHS] {
    if depth_m <= 0.0 {
        return [0.0; DEPTHS];
    }
    [
        1.0,
        depth_m.max(NEAREST_M).ln() - 2.0,
        1.0 / (1.0 + depth_m / 4.0),
        (depth_m * std::f32::consts::TAU).sin() / (1.0 + depth_m / 8.0),
    ]
}

/// Encoder of time of day, weather and camera to one vector per view.
pub(super) struct Light<B: Ops> {
    times: Vec<f32>,    // [time, or not told][width]
    weathers: Vec<f32>, // [weather, or not told][width]
    camera: B::Linear,
    width: usize,
}

impl<B: Ops> Light<B> {
    /// Takes `times`, `weathers` and `camera`.
    pub(super) fn new(ops: &B, w: &mut WeightFile<'_>, width: usize) -> Result<Self, WeightsError> {
        Ok(Self {
            times: w.take("times.weight", &[TIMES + 1, width])?,
            weathers: w.take("weathers.weight", &[WEATHERS + 1, width])?,
            camera: ops.linear(w, "camera", [CAMERA_NUMBERS, width], &[])?,
            width,
        })
    }

    fn of(&self, ops: &B, condition: &Condition) -> Result<Vec<B::Tensor>, ModelError> {
        let row = |table: &[f32], at: usize| table[at * self.width..][..self.width].to_vec();
        let time = row(&self.times, condition.time.unwrap_or(TIMES));
        let weather = row(&self.weathers, condition.weather.unwrap_or(WEATHERS));
        let sum = ops.vector(time.iter().zip(&weather).map(|(a, b)| a + b).collect())?;
        let each = condition.cameras.iter().map(|camera| {
            let camera = ops.vector(camera.to_vec())?;
            Ok(ops.add(ops.apply(&self.camera, &camera, 1)?, &sum)?)
        });
        each.collect()
    }
}
