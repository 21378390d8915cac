//! Scenery, regenerated from a seed: by rules or by a network, everywhere or in a region, as things that can be edited.
//! Nothing else changes.

use editor::{Edit, Shape};
use job::GenError;
use job::inpaint::InpaintMask;
use job::network_scenery::drawn_scenery;
use job::pipeline::windows_over;
use nets::scenery::SceneryNet;
use scene::raster::box_cells;
use scene::{Background, BevLayer, Class, Extent, Form, Lattice, Scene, Thing, ThingId, Window};
use world::scenery::{self, RoadsideKind, RoadsideStyle, Style};

use super::scenery_around;

/// Share of vegetation (`Density`) that is usual.
pub const TYPICAL_VEGETATION: f64 = 0.5;
/// Share of buildings (`Density`) that is usual.
pub const TYPICAL_BUILDING: f64 = 0.6;

/// Method that draws scenery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneryMethod {
    /// The rules of the procedural worlds, for a kind of place; none: one that suits the road.
    Rules(Option<RoadsideKind>),
    /// A small diffusion network that has seen such worlds and looks at the road and at what stays.
    Network,
}

impl SceneryMethod {
    /// All methods, in the order of lists.
    pub fn all() -> impl Iterator<Item = Self> {
        let settings = RoadsideKind::ALL.map(|setting| Self::Rules(Some(setting)));
        [Self::Rules(None), Self::Network].into_iter().chain(settings)
    }

    /// Its name in lists.
    pub fn label(self) -> &'static str {
        match self {
            Self::Rules(None) => "Suits the road",
            Self::Rules(Some(setting)) => setting.label(),
            Self::Network => "By a network",
        }
    }
}

/// A request for scenery.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneryWish {
    /// Fixes every random draw.
    pub seed: u64,
    /// Method that draws it.
    pub by: SceneryMethod,
    /// Number of plants, 1 = usual there; 0 is none.
    pub green: f64,
    /// Number of buildings, 1 = usual there; 0 is none.
    pub built: f64,
    /// Cells in which it is drawn; empty: everywhere.
    pub region: InpaintMask,
}

impl SceneryWish {
    /// Scenery that suits the road, everywhere.
    pub fn of_seed(seed: u64) -> Self {
        Self {
            seed,
            by: SceneryMethod::Rules(None),
            green: 1.0,
            built: 1.0,
            region: InpaintMask::default(),
        }
    }

    /// Edits that regenerate the scenery of the frame that a scene shows. Things that stand wholly in the region are
    /// removed unless they were placed ([`Thing::placed`]) or are locked; so are voxels of scenery there that belong to
    /// no thing. New things keep clear of everything that stays, and of the region's border. On a larger map this is
    /// done window by window.
    pub fn edits(&self, scene: &Scene) -> Result<Vec<Edit>, GenError> {
        let locked = &scene.arranged.locked.things;
        self.edits_without(scene, |t| !t.placed && !locked.contains(&t.id))
    }

    /// Edits that draw scenery around all things that are there.
    pub fn edits_around(&self, scene: &Scene) -> Result<Vec<Edit>, GenError> {
        self.edits_without(scene, |_| false)
    }

    /// Edits that draw scenery in place of the things for which `may_go` is true.
    fn edits_without(&self, scene: &Scene, may_go: impl Fn(&Thing) -> bool) -> Result<Vec<Edit>, GenError> {
        let map = scene.frame().extent();
        if map.lattice() != Lattice::OCC3D {
            return Err(GenError::failed(format!(
                "scenery is drawn on maps of voxels of {} m, and this one is of {}",
                Lattice::OCC3D.voxel_m(),
                map.lattice()
            )));
        }
        let (mut ids, mut forms, mut cleared) = (Vec::new(), Vec::new(), Vec::new());
        for (place, own) in windows_over(map) {
            let to_window = place.to_window();
            let wish = Self {
                seed: place.seed(self.seed),
                region: self.region.from_cell(place.0),
                ..self.clone()
            };
            let mut columns = wish.columns();
            if map != Extent::WINDOW {
                let owned = to_window.extent(own);
                for (column, [x, y]) in columns.iter_mut().zip(Extent::WINDOW.all_columns()) {
                    let p = Extent::WINDOW.center(x, y, 0);
                    *column &= owned.column_at(p.x, p.y).is_some();
                }
            }
            if !columns.contains(&true) {
                continue;
            }
            let within = match map == Extent::WINDOW {
                true => scene.clone(),
                false => scene.window_at(to_window),
            };
            let drawn = wish.in_window(&within, &columns, map == Extent::WINDOW, &may_go)?;
            ids.extend(drawn.0);
            let things: Background = drawn.1.into_iter().collect();
            let back = scene::Pose {
                rotation: glam::DQuat::IDENTITY,
                translation_m: to_window.back().way_m().extend(0.0),
            };
            let on_map = match map == Extent::WINDOW {
                true => things,
                false => things.in_frame(&back),
            };
            forms.extend(on_map.iter().map(|t| t.form.clone()));
            cleared.extend(on_the_map(map, place.extent(), &columns));
        }
        let mut edits = Vec::new();
        if !ids.is_empty() {
            edits.push(Edit::RemoveThings { ids });
        }
        let shape = (!self.region.is_empty()).then_some(Shape::Cells(cleared));
        edits.push(Edit::ClearScenery { shape });
        if !forms.is_empty() {
            edits.push(Edit::DrawScenery { forms });
        }
        Ok(edits)
    }

    /// The things that are removed and the ones that are added in some columns of a window. With `alone`, things may
    /// also stand beside the window.
    fn in_window(
        &self,
        scene: &Scene,
        columns: &[bool],
        alone: bool,
        may_go: &dyn Fn(&Thing) -> bool,
    ) -> Result<(Vec<ThingId>, Vec<Thing>), GenError> {
        let frame = scene.frame();
        let whole = |form: &Form| {
            let (mut inside, mut beyond) = (true, true);
            scenery_around::columns(Extent::WINDOW, form, Window::VOXEL_M, |x, y| {
                inside &= columns[x * Window::NY + y];
                beyond = false;
            });
            (inside, beyond)
        };
        let comes = |form: &Form| match whole(form) {
            (inside, false) => inside,
            (_, true) => alone,
        };
        let goes = |form: &Form| whole(form) == (true, false);
        let (mut ids, mut stays) = (Vec::<ThingId>::new(), Background::default());
        for thing in scene.background.iter() {
            match may_go(thing) && goes(&thing.form) {
                true => ids.push(thing.id),
                false => drop(stays.add(thing.form.clone())),
            }
        }
        let drawn = match self.by {
            SceneryMethod::Rules(setting) => {
                let style = self.style(scene, setting);
                scenery::background_of(&frame.layout, &frame.boxes, &style, self.seed)
            }
            SceneryMethod::Network => self.by_network(scene, columns)?,
        };
        let drawn: Background = drawn.iter().filter(|t| comes(&t.form)).cloned().collect();
        let known = stays.len();
        let merged = scenery_around::merged(Extent::WINDOW, stays, &drawn);
        Ok((ids, merged.iter().skip(known).cloned().collect()))
    }

    fn by_network(&self, scene: &Scene, columns: &[bool]) -> Result<Background, GenError> {
        let net = SceneryNet::bundled().map_err(GenError::failed)?;
        // Usual amounts are left to the network.
        let named = |times: f64, typical: f64| (times != 1.0).then(|| (times * typical).min(1.0) as f32);
        let named = [
            named(self.green, TYPICAL_VEGETATION),
            named(self.built, TYPICAL_BUILDING),
            None,
        ];
        let drawn = drawn_scenery(&net, scene, columns, named, self.seed)?;
        // The network only takes a share as a hint; an amount of 0 must give none.
        let wanted = |form: &Form| match form.class() {
            Class::Vegetation => self.green > 0.0,
            _ => self.built > 0.0,
        };
        let paved = Paved::from_scene(scene);
        let fits = |form: &Form| wanted(form) && paved.leaves_room(form);
        Ok(drawn.iter().filter(|t| fits(&t.form)).cloned().collect())
    }

    fn style(&self, scene: &Scene, setting: Option<RoadsideKind>) -> Style {
        let wanted = |side: RoadsideStyle| RoadsideStyle {
            green: side.green * self.green,
            built: side.built * self.built,
            ..side
        };
        let style = match setting {
            Some(setting) => Style::both(RoadsideStyle::usual(setting)),
            None => Style::drawn(&scene.frame().layout, self.seed),
        };
        Style {
            left: wanted(style.left),
            right: wanted(style.right),
        }
    }

    /// Columns of the region, `[x * NY + y]`.
    fn columns(&self) -> Vec<bool> {
        match self.region.is_empty() {
            true => vec![true; Window::COLUMNS],
            false => self.region.columns(Extent::WINDOW),
        }
    }
}

/// Columns of a map, `[x, y]`, from flags of a window's columns.
fn on_the_map(map: Extent, window: Extent, flags: &[bool]) -> Vec<[usize; 2]> {
    let flags = map.crop(&window, flags, false);
    let set = map.all_columns().zip(flags).filter(|(_, set)| *set);
    set.map(|(column, _)| column).collect()
}

/// Columns on which things of the network must not stand.
struct Paved {
    /// Road, car park and boxes.
    driven: Vec<bool>,
    /// These and walkways.
    all: Vec<bool>,
}

impl Paved {
    /// Largest share of a building, hedge or wall that may lie on paving: its edge is drawn to half a metre.
    const MOST: f64 = 0.04;

    fn from_scene(scene: &Scene) -> Self {
        let frame = scene.frame();
        let held = |bits: u32| {
            frame
                .layout
                .cells()
                .iter()
                .map(|c| c & bits != 0)
                .collect::<Vec<bool>>()
        };
        let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
        let [mut driven, mut all] = [held(road), held(road | BevLayer::Walkway.bit())];
        for b in frame.boxes.values() {
            box_cells(Extent::WINDOW, b, 0.0, |x, y| {
                driven[x * Window::NY + y] = true;
                all[x * Window::NY + y] = true;
            });
        }
        Self { driven, all }
    }

    /// True if a form keeps off the paving. Trees count by their trunk, since crowns may overhang; poles and signs may
    /// stand on a walkway.
    fn leaves_room(&self, form: &Form) -> bool {
        let (taken, at) = match form {
            Form::Tree(t) => (&self.all, Some(t.position_m)),
            Form::Post(p) => (&self.driven, Some(p.position_m)),
            _ => (&self.all, None),
        };
        if let Some(at) = at {
            return Window::column_at(at.x, at.y).is_none_or(|[x, y]| !taken[x * Window::NY + y]);
        }
        let (mut on, mut columns) = (0, 0);
        scenery_around::columns(Extent::WINDOW, form, 0.0, |x, y| {
            on += usize::from(taken[x * Window::NY + y]);
            columns += 1;
        });
        on as f64 <= Self::MOST * f64::from(columns)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::open;
    use editor::Document;
    use scene::VoxelGrid;
    use scene::background::{Building, Tree, TreeKind};

    fn wish(seed: u64) -> SceneryWish {
        SceneryWish {
            seed,
            by: SceneryMethod::Rules(Some(RoadsideKind::OldTown)),
            green: 1.0,
            built: 1.0,
            region: InpaintMask::default(),
        }
    }

    fn scenery_voxels(grid: &VoxelGrid) -> usize {
        let counts = grid.class_counts();
        counts[usize::from(Class::Manmade.id())] + counts[usize::from(Class::Vegetation.id())]
    }

    #[test]
    fn locked_things_stand_when_scenery_is_drawn_anew() {
        let mut document = Document::new(open::from_template("straight", 7).expect("a template"));
        let kept = document
            .scene()
            .background
            .iter()
            .next()
            .expect("a thing")
            .clone();
        let lock = Edit::Arrange {
            boxes: Vec::new(),
            things: vec![kept.id],
            how: scene::Arrangement::Lock,
        };
        document.apply("Lock", &lock).expect("there");
        let edits = wish(11).edits(document.scene()).expect("rules");
        document.apply_all("Draw scenery", &edits).expect("sound");
        let after = &document.scene().background;
        assert_eq!(after.get(kept.id), Some(&kept));
        assert!(after.len() > 1);
    }

    /// Things that were placed or moved by hand, words or a file stay unchanged; new things keep clear of them.
    #[test]
    fn what_was_placed_stands_when_scenery_is_drawn_anew() {
        let mut document = Document::new(open::from_template("straight", 7).expect("a template"));
        let drawn = document.scene().background.len();
        let house = Building::rectangle(DVec2::new(-25.0, 25.0), DVec2::splat(4.0), DVec2::X, 7.0);
        let add = Edit::AddThings {
            forms: vec![Form::Building(house)],
        };
        document.apply("Add a house", &add).expect("sound");
        let moved = document.scene().background.iter().next().expect("a thing").id;
        let shift = Edit::MoveThings {
            ids: vec![moved],
            by_m: DVec2::new(0.4, 0.0),
            turn_deg: 0.0,
        };
        document.apply("Move a thing", &shift).expect("sound");
        let placed = |document: &Document| -> Vec<Thing> {
            let all = document.scene().background.iter();
            all.filter(|t| t.placed).cloned().collect()
        };
        let hands = placed(&document);
        assert_eq!(hands.len(), 2);
        for seed in 11..14 {
            let before = document.scene().background.clone();
            let edits = wish(seed).edits(document.scene()).expect("rules");
            document.apply_all("Draw scenery", &edits).expect("sound");
            let after = &document.scene().background;
            assert_eq!(placed(&document), hands, "seed {seed}");
            assert!(*after != before && after.len() > 2 && drawn > 2);
            let house = &hands[1].form;
            let mut own = std::collections::BTreeSet::new();
            scenery_around::columns(Extent::WINDOW, house, 0.0, |x, y| {
                own.insert([x, y]);
            });
            for thing in after.iter().filter(|t| t.id != hands[1].id) {
                scenery_around::columns(Extent::WINDOW, &thing.form, 0.0, |x, y| {
                    assert!(!own.contains(&[x, y]), "{:?} stands in the house", thing.form);
                });
            }
        }
    }

    #[test]
    fn a_region_is_regenerated_and_the_rest_stays() {
        let scene = open::from_template("straight", 7).expect("a template");
        let mut document = Document::new(scene);
        let before = document.scene().clone();
        let region = InpaintMask::of_rect(Extent::WINDOW, DVec2::new(0.0, -40.0), DVec2::new(40.0, 40.0));
        let wish = SceneryWish { region, ..wish(11) };
        document
            .apply_all("Draw scenery", &wish.edits(&before).expect("rules"))
            .expect("sound");
        let after = document.scene().clone();
        assert_ne!(after.background, before.background);
        let (old, new) = (&before.frame().occupancy, &after.frame().occupancy);
        let columns = wish.columns();
        let mut changed = 0;
        for (c, inside) in columns.iter().enumerate() {
            let (x, y) = (c / Window::NY, c % Window::NY);
            let differs = old.column(x, y) != new.column(x, y);
            assert!(*inside || !differs, "column ({x}, {y}) lies outside");
            changed += usize::from(differs);
        }
        assert!(changed > 500, "{changed}");
        // The networks have nothing left to generate.
        let region = job::region::Region::of_edit(after.frame(), 2);
        assert!(region.is_empty());
        document.undo();
        assert!(document.scene().frame().occupancy == before.frame().occupancy);
    }

    #[test]
    fn scenery_without_things_goes_and_none_can_be_asked_for() {
        // Buildings that belong to no thing, as in a scene of generated voxels.
        let mut scene = open::from_template("straight", 7).expect("a template");
        scene.background = Default::default();
        assert!(scenery_voxels(&scene.frame().occupancy) > 1000);
        let nothing = SceneryWish {
            green: 0.0,
            built: 0.0,
            by: SceneryMethod::Rules(Some(RoadsideKind::Country)),
            ..wish(3)
        };
        let mut document = Document::new(scene);
        let edits = nothing.edits(document.scene()).expect("rules");
        document.apply_all("Draw scenery", &edits).expect("sound");
        let left = scenery_voxels(&document.scene().frame().occupancy);
        let town = wish(3).edits(document.scene()).expect("rules");
        document.apply_all("Draw scenery", &town).expect("sound");
        let scene = document.scene().clone();
        let built = scenery_voxels(&scene.frame().occupancy);
        assert!(built > 10 * left.max(100), "{left} {built}");
        // The same wish gives the same things; another seed others.
        let again = wish(3).edits(&scene).expect("rules");
        document.apply_all("Draw scenery", &again).expect("sound");
        let forms = |s: &Scene| s.background.iter().map(|t| t.form.clone()).collect::<Vec<_>>();
        assert_eq!(forms(document.scene()), forms(&scene));
        let other = wish(4).edits(&scene).expect("rules");
        document.apply_all("Draw scenery", &other).expect("sound");
        assert_ne!(forms(document.scene()), forms(&scene));
    }

    #[test]
    fn what_a_network_draws_leaves_paths_and_boxes_free() {
        let scene = open::from_template("straight", 7).expect("a template");
        let (frame, paved) = (scene.frame(), Paved::from_scene(&scene));
        let centre = |c: usize| {
            let column = DVec2::new((c / Window::NY) as f64, (c % Window::NY) as f64);
            (column + 0.5) * Window::VOXEL_M - 40.0
        };
        let cells = frame.layout.cells();
        let found = |has: BevLayer, not: u32| {
            let at = cells.iter().position(|c| c & has.bit() != 0 && c & not == 0);
            centre(at.expect("a column of that layer"))
        };
        let road = found(BevLayer::DrivableArea, 0);
        let walkway = found(BevLayer::Walkway, BevLayer::DrivableArea.bit());
        let grass = centre(cells.iter().position(|c| *c == 0).expect("grass"));
        let parked = frame.boxes.values().next().expect("a box").center_m.truncate();
        let house = |at: DVec2| Form::Building(Building::rectangle(at, DVec2::splat(0.9), DVec2::X, 5.0));
        let tree = |at: DVec2| {
            Form::Tree(Tree {
                position_m: at,
                height_m: 6.0,
                crown_radius_m: 3.0,
                kind: TreeKind::Broadleaf,
            })
        };
        for (place, at, free) in [
            ("road", road, false),
            ("walkway", walkway, false),
            ("box", parked, false),
            ("grass", grass, true),
        ] {
            assert_eq!(paved.leaves_room(&house(at)), free, "a house on {place}");
            assert_eq!(paved.leaves_room(&tree(at)), free, "a tree on {place}");
        }
        // A crown may hang over a walkway.
        let beside = cells.iter().enumerate().position(|(c, layers)| {
            *layers == 0 && !paved.all[c] && (1..4).any(|k| paved.all.get(c + k).is_some_and(|p| *p))
        });
        assert!(paved.leaves_room(&tree(centre(beside.expect("a verge")))));
    }

    #[test]
    fn a_network_draws_in_a_region_and_keeps_the_road_free() {
        let scene = open::from_template("straight", 7).expect("a template");
        let region = InpaintMask::of_rect(Extent::WINDOW, DVec2::new(-40.0, -40.0), DVec2::new(10.0, 40.0));
        let by_network = |seed, green| SceneryWish {
            by: SceneryMethod::Network,
            green,
            region: region.clone(),
            ..wish(seed)
        };
        let drawn = |wish: SceneryWish| {
            let mut document = Document::new(scene.clone());
            let edits = wish.edits(&scene).expect("the shipped weights");
            document.apply_all("Draw scenery", &edits).expect("sound");
            document.scene().clone()
        };
        let first = drawn(by_network(5, 1.0));
        let (old, new) = (&scene.frame().occupancy, &first.frame().occupancy);
        let bev = scene::raster::bev_channels(&scene.frame().layout, scene.frame().boxes.values());
        let (columns, mut come) = (by_network(5, 1.0).columns(), 0);
        for (c, inside) in columns.iter().enumerate() {
            let (x, y) = (c / Window::NY, c % Window::NY);
            let (before, after) = (old.column(x, y), new.column(x, y));
            assert!(*inside || before == after, "column ({x}, {y}) lies outside");
            let built = |column: &[u8]| column.contains(&Class::Manmade.id());
            let road = bev[c] & scene::BevLayer::DrivableArea.bit() != 0;
            assert!(
                !road || !built(after) || built(before),
                "built on the road at ({x}, {y})"
            );
            come += usize::from(before != after);
        }
        assert!(come > 300, "{come}");
        let forms = |s: &Scene| s.background.iter().map(|t| t.form.clone()).collect::<Vec<_>>();
        assert_eq!(forms(&drawn(by_network(5, 1.0))), forms(&first));
        assert_ne!(forms(&drawn(by_network(6, 1.0))), forms(&first));
        // Many plants or none, as asked for; plants that reach out of the region stay.
        let plants = |s: &Scene| {
            let forms = s.background.iter().map(|t| t.form.clone());
            forms
                .filter(|f| f.class() == Class::Vegetation)
                .collect::<Vec<_>>()
        };
        let (none, much) = (drawn(by_network(5, 0.0)), drawn(by_network(5, 1.8)));
        let old = plants(&scene);
        assert!(
            plants(&none).iter().all(|form| old.contains(form)),
            "none is none"
        );
        assert!(plants(&much).len() > plants(&none).len() + 10);
    }
}
