//! Ways to forecast the frames of a drive after the first two.

use std::collections::BTreeMap;
use std::path::Path;

use super::figures::{column_in, moved_on, moving_columns, pose};
use authoring::drives::{DriveFrame, FRAMES, STEP_S};
use job::drive::DriveNetwork;
use nets::{CELLS, CHANNELS, DitCondition, LATENT, OccDitTime, OccModels, SIDE, TimeDecoder, column_heights};
use nn::weights::{self, WeightFile, WeightsError};
use scene::clip::ObjectVoxels;
use scene::{
    BevLayout, BoxId, Class, Density, Extent, Pose, SceneBox, VoxelGrid, VoxelPaint, Window, draft, raster,
};

/// Number of known frames.
pub const KNOWN: usize = 2;
/// Steps of the sampler.
const STEPS: usize = 12;

/// Source of the layouts of the frames to come.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// The layouts that came.
    Came,
    /// The last known layout, continued beyond its edge, and its boxes at their speed.
    Expected,
}

/// A way to forecast.
#[derive(Clone, Copy)]
pub struct ForecastMethod {
    /// Name in reports.
    pub name: &'static str,
    how: How,
}

#[derive(Clone, Copy)]
enum How {
    Warped,
    ConstantVelocity,
    Draft,
    Single,
    Together,
    WithoutDecoder,
    SameCell,
    Canvas,
}

/// All methods.
pub const METHODS: [ForecastMethod; 8] = [
    ForecastMethod {
        name: "last frame, warped",
        how: How::Warped,
    },
    ForecastMethod {
        name: "constant velocity",
        how: How::ConstantVelocity,
    },
    ForecastMethod {
        name: "draft of the layout",
        how: How::Draft,
    },
    ForecastMethod {
        name: "single frames",
        how: How::Single,
    },
    ForecastMethod {
        name: "temporal, same cell",
        how: How::SameCell,
    },
    ForecastMethod {
        name: "temporal, old decoder",
        how: How::WithoutDecoder,
    },
    ForecastMethod {
        name: "temporal",
        how: How::Together,
    },
    ForecastMethod {
        name: "canvas, inpainted",
        how: How::Canvas,
    },
];

/// Layout, boxes and pose of a frame to come, as far as the method knows them.
struct ForecastCondition {
    layout: BevLayout,
    boxes: BTreeMap<BoxId, SceneBox>,
    pose: Pose,
}

/// The networks that forecast.
pub struct Drives<'a> {
    models: &'a OccModels,
    time: OccDitTime,
    decoder: TimeDecoder,
    /// The ablation; only a folder of weights may hold it.
    same_cell: Option<OccDitTime>,
}

/// File of the ablation in a folder of weights.
const SAME_CELL: &str = "occ_dit_time_same_cell.safetensors";

impl<'a> Drives<'a> {
    /// Reads the networks from a folder of weights, or takes those that ship. Errors if the folder lacks one of the
    /// networks other than the ablation, or if one is damaged.
    pub fn new(models: &'a OccModels, folder: Option<&Path>) -> anyhow::Result<Self> {
        let read = |name| -> Result<Option<Vec<u8>>, WeightsError> {
            let path = folder.map(|f| f.join(name));
            let path = path.filter(|p| name != SAME_CELL || p.exists());
            path.map(|p| weights::read(&p)).transpose()
        };
        let time = |name: &'static str| -> Result<Option<OccDitTime>, WeightsError> {
            let bytes = read(name)?;
            bytes
                .map(|b| OccDitTime::new(WeightFile::parse(name, &b)?))
                .transpose()
        };
        Ok(Self {
            models,
            time: time(OccDitTime::FILE)?.map_or_else(OccDitTime::bundled, Ok)?,
            decoder: match read(TimeDecoder::FILE)? {
                Some(bytes) => TimeDecoder::new(WeightFile::parse(TimeDecoder::FILE, &bytes)?)?,
                None => TimeDecoder::bundled()?,
            },
            same_cell: time(SAME_CELL)?,
        })
    }

    /// The frames after the known ones; `None` if the method's weights are missing.
    pub fn forecast(
        &self,
        method: ForecastMethod,
        truth: &[DriveFrame],
        wish: Wish,
        seed: u64,
    ) -> anyhow::Result<Option<Vec<VoxelGrid>>> {
        let told: Vec<ForecastCondition> = (KNOWN..truth.len()).map(|i| told(truth, i, wish)).collect();
        let last = &truth[KNOWN - 1];
        Ok(Some(match method.how {
            How::Warped => told
                .iter()
                .map(|to| warped(&last.dense, &pose(last), to))
                .collect(),
            How::ConstantVelocity => told
                .iter()
                .enumerate()
                .map(|(i, to)| moved_world(&[PosedVoxels::from_frame(last)], last, to, i).0)
                .collect(),
            How::Draft => told
                .iter()
                .map(|to| draft::draft(&to.layout, to.boxes.values()))
                .collect(),
            How::Single => self.drawn((None, None), truth, &told, seed)?,
            How::Together => self.drawn((Some(&self.time), Some(&self.decoder)), truth, &told, seed)?,
            How::WithoutDecoder => self.drawn((Some(&self.time), None), truth, &told, seed)?,
            How::SameCell => match &self.same_cell {
                Some(time) => self.drawn((Some(time), Some(&self.decoder)), truth, &told, seed)?,
                None => return Ok(None),
            },
            How::Canvas => self.on_canvas(last, &told, seed)?,
        }))
    }

    /// Frames drawn by the networks, with the known frames as context. If there are more frames than the networks draw
    /// at once, they are drawn in parts, and the last frames of a part are known to the next.
    fn drawn(
        &self,
        (time, decoder): (Option<&OccDitTime>, Option<&TimeDecoder>),
        truth: &[DriveFrame],
        told: &[ForecastCondition],
        seed: u64,
    ) -> anyhow::Result<Vec<VoxelGrid>> {
        let last = &truth[KNOWN - 1];
        let density = Density::from_grid(&last.dense, last.layout.cells());
        let vae = &self.models.vae;
        let mut known: Vec<(DitCondition, [f64; 3])> = Vec::new();
        for frame in &truth[..KNOWN] {
            let condition = self.condition(&frame.layout, &frame.boxes, density)?;
            known.push((self.known(condition, &frame.dense)?, frame.pose));
        }
        let mut poses = truth[KNOWN..].iter().map(|f| f.pose);
        let mut out: Vec<VoxelGrid> = Vec::new();
        for (part, told) in told.chunks(FRAMES - KNOWN).enumerate() {
            let mut frames = known;
            for (to, pose) in told.iter().zip(&mut poses) {
                frames.push((self.condition(&to.layout, &to.boxes, density)?, pose));
            }
            let (conditions, poses): (Vec<DitCondition>, Vec<[f64; 3]>) = frames.into_iter().unzip();
            let network = DriveNetwork {
                models: self.models,
                time,
                steps: STEPS,
                seed: seed.wrapping_add((part as u64) << 16),
            };
            let mut latents = network.draw(&conditions, &poses, STEP_S)?;
            for (latent, condition) in latents.iter_mut().zip(&conditions).take(KNOWN) {
                latent.clone_from(&condition.context);
            }
            if let Some(decoder) = decoder {
                latents = decoder.apply(&latents, &poses, STEP_S)?;
            }
            let decoded: Result<Vec<_>, _> = latents[KNOWN..].iter().map(|l| vae.decode(l)).collect();
            out.extend(decoded?);
            known = Vec::new();
            if out.len() < KNOWN {
                break;
            }
            let newest = conditions.into_iter().zip(poses).rev().take(KNOWN).rev();
            for ((condition, pose), grid) in newest.zip(&out[out.len() - KNOWN..]) {
                known.push((self.known(condition, grid)?, pose));
            }
        }
        Ok(out)
    }

    /// A frame whose voxels are known.
    fn known(&self, condition: DitCondition, grid: &VoxelGrid) -> anyhow::Result<DitCondition> {
        Ok(DitCondition {
            context: self.models.vae.encode(grid)?,
            mask: vec![0.0; CELLS],
            ..condition
        })
    }

    /// Frames drawn on the canvas: seen or drawn places stay, moving objects go on, and the networks draw what comes
    /// into view.
    fn on_canvas(
        &self,
        last: &DriveFrame,
        told: &[ForecastCondition],
        seed: u64,
    ) -> anyhow::Result<Vec<VoxelGrid>> {
        let density = Density::from_grid(&last.dense, last.layout.cells());
        let vae = &self.models.vae;
        let mut seen_from = vec![PosedVoxels::from_frame(last)];
        let mut out = Vec::new();
        for (i, to) in told.iter().enumerate() {
            let (world, seen) = moved_world(&seen_from, last, to, i);
            let mut condition = self.condition(&to.layout, &to.boxes, density)?;
            let hidden = |cell: usize| {
                let (x, y) = (cell / SIDE * 4, cell % SIDE * 4);
                (0..16).any(|c| !seen[(x + c / 4) * Window::NY + y + c % 4])
            };
            condition.mask = (0..CELLS).map(|cell| f32::from(u8::from(hidden(cell)))).collect();
            let latent = vae.encode(&world)?;
            let kept = |i: usize| latent[i] * (1.0 - condition.mask[i / CHANNELS]);
            condition.context = (0..LATENT).map(kept).collect();
            let network = DriveNetwork {
                models: self.models,
                time: None,
                steps: STEPS,
                seed: seed.wrapping_add(i as u64),
            };
            let latents = network.draw(std::slice::from_ref(&condition), &[[0.0; 3]], STEP_S)?;
            let mut grid = vae.decode(&latents[0])?;
            for c in (0..Window::COLUMNS).filter(|c| seen[*c]) {
                let (x, y) = (c / Window::NY, c % Window::NY);
                *grid.window_column_mut(x, y) = *world.window_column(x, y);
            }
            seen_from.push(PosedVoxels {
                grid: grid.clone(),
                pose: to.pose,
                moving: moving_columns(to.boxes.values()),
            });
            out.push(grid);
        }
        Ok(out)
    }

    /// Condition of a frame to be drawn from layout and boxes alone.
    fn condition(
        &self,
        layout: &BevLayout,
        boxes: &BTreeMap<BoxId, SceneBox>,
        density: Density,
    ) -> anyhow::Result<DitCondition> {
        let drafted = draft::draft(layout, boxes.values());
        let Density {
            vegetation,
            building,
            clutter,
            completeness,
        } = density;
        Ok(DitCondition {
            bev: raster::bev_channels(layout, boxes.values()),
            heading: raster::headings(Extent::WINDOW, boxes.values()),
            named: [vegetation, building, clutter, completeness].map(Some),
            draft_latent: self.models.vae.encode(&drafted)?,
            given: vec![[0.0; 2]; CELLS],
            columns: column_heights(&drafted, &drafted),
            ground: true,
            mask: vec![1.0; CELLS],
            context: vec![0.0; LATENT],
        })
    }
}

/// Layout, boxes and pose that a method knows of frame `i`. The vehicle's own path is always known.
fn told(truth: &[DriveFrame], i: usize, wish: Wish) -> ForecastCondition {
    let (last, came) = (&truth[KNOWN - 1], &truth[i]);
    let to = pose(came);
    if wish == Wish::Came {
        return ForecastCondition {
            layout: came.layout.clone(),
            boxes: came.boxes.clone(),
            pose: to,
        };
    }
    let from = pose(last);
    let seconds = (i + 1 - KNOWN) as f64 * STEP_S;
    let boxes = last
        .boxes
        .iter()
        .map(|(id, b)| (*id, moved_on(b, seconds, &from, &to)))
        .collect();
    // Beyond its edge the map is continued by the cells of the edge.
    let most = Window::NX as f64 * Window::VOXEL_M / 2.0 - 0.1;
    let at = |x: usize, y: usize| {
        let p = from
            .inverse()
            .apply(to.apply(Window::center(x, y, 0).with_z(0.0)));
        Extent::WINDOW
            .column_at(p.x.clamp(-most, most), p.y.clamp(-most, most))
            .unwrap_or([0, 0])
    };
    let cells = Extent::WINDOW.all_columns().map(|[x, y]| {
        let [i, j] = at(x, y);
        last.layout.cell(i, j)
    });
    let mut layout = BevLayout::from_cells(cells.collect(), Vec::new()).unwrap_or_default();
    if !last.layout.relief.is_flat() {
        layout.relief = scene::Relief::from_fn(Extent::WINDOW, |p| {
            let q = from.inverse().apply(to.apply(p.extend(0.0)));
            last.layout.relief.height_m(q.truncate())
        });
    }
    ForecastCondition {
        layout,
        boxes,
        pose: to,
    }
}

/// A frame's voxels seen from another pose; free where the frame saw nothing.
fn warped(grid: &VoxelGrid, from: &Pose, to: &ForecastCondition) -> VoxelGrid {
    let mut out = VoxelGrid::new();
    for [x, y] in Extent::WINDOW.all_columns() {
        if let Some([i, j]) = column_in(Window::center(x, y, 0), &to.pose, from) {
            *out.window_column_mut(x, y) = *grid.window_column(i, j);
        }
    }
    out
}

/// Voxels seen from one place.
struct PosedVoxels {
    grid: VoxelGrid,
    pose: Pose,
    /// Columns, `[x][y]`, in which something moves.
    moving: Vec<bool>,
}

impl PosedVoxels {
    fn from_frame(frame: &DriveFrame) -> Self {
        Self {
            grid: frame.dense.clone(),
            pose: pose(frame),
            moving: moving_columns(frame.boxes.values()),
        }
    }
}

/// The world `i + 1` steps after the last known frame: standing things as they were first seen, moving ones at their
/// speed, the draft beyond; and which columns were seen.
fn moved_world(
    seen_from: &[PosedVoxels],
    last: &DriveFrame,
    to: &ForecastCondition,
    i: usize,
) -> (VoxelGrid, Vec<bool>) {
    let from = pose(last);
    let drafted = draft::draft(&to.layout, to.boxes.values());
    let ground = draft::draft(&to.layout, std::iter::empty());
    let (mut out, mut seen) = (drafted, vec![false; Window::COLUMNS]);
    for [x, y] in Extent::WINDOW.all_columns() {
        let first = seen_from.iter().find_map(|was| {
            let [i, j] = column_in(Window::center(x, y, 0), &to.pose, &was.pose)?;
            Some((was, i, j))
        });
        let Some((was, i, j)) = first else {
            continue;
        };
        seen[x * Window::NY + y] = true;
        *out.window_column_mut(x, y) = match was.moving[i * Window::NY + j] {
            true => *ground.window_column(x, y),
            false => *was.grid.window_column(i, j),
        };
    }
    let seconds = (i + 1) as f64 * STEP_S;
    let painted = VoxelPaint::over(Extent::WINDOW);
    for b in last.boxes.values().filter(|b| b.velocity_mps.length() > 0.1) {
        let voxels = ObjectVoxels::cut(&last.dense, b, |_, label| {
            label == b.class.id() && label != Class::FREE
        });
        voxels.stamp(&mut out, &painted, b, &moved_on(b, seconds, &from, &to.pose));
    }
    (out, seen)
}
