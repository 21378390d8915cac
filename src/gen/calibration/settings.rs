//! The settings that are tried: the default, each knob by itself, and random ones across all knobs (a Latin hypercube:
//! every knob's values occur equally often).

use diffusion::solver::SolverKind;
use job::{GenParams, Precision};
use trade::PresetKnobs;
use world::draw::Draw;

/// A setting with a name.
#[derive(Clone, Debug)]
pub struct CandidateSetting {
    /// The knobs that differ from the default: `steps 4, int8`.
    pub name: String,
    /// All parameters.
    pub params: GenParams,
    /// True if it asks for another result than the reference: its distance to the reference is then no numerical error.
    pub other_target: bool,
}

/// Name of the knobs, by those that differ from `base`.
pub fn name_of(knobs: &PresetKnobs, base: &PresetKnobs) -> String {
    let mut parts = vec![format!("{} steps", knobs.steps)];
    if knobs.solver != base.solver {
        parts.push(knobs.solver.name().into());
    }
    if knobs.precision == Precision::Int8 {
        parts.push("int8".into());
    }
    if !knobs.local {
        parts.push("dense".into());
    } else if knobs.halo_tokens != base.halo_tokens {
        parts.push(format!("halo {}", knobs.halo_tokens));
    }
    if knobs.inversion_iterations > 0 {
        parts.push(format!("{} fixed points", knobs.inversion_iterations));
    }
    if knobs.reuse_steps > 1 {
        parts.push(format!("middle every {} steps", knobs.reuse_steps));
    }
    match knobs.fine_steps {
        same if same == base.fine_steps => {}
        0 => parts.push("no fine stage".into()),
        n => parts.push(format!("fine stage {n} steps")),
    }
    parts.join(", ")
}

/// Settings of one base, each only once.
struct List {
    base: GenParams,
    settings: Vec<CandidateSetting>,
}

impl List {
    fn new(base: GenParams) -> Self {
        let mut list = Self {
            base: base.clone(),
            settings: Vec::new(),
        };
        list.add(base);
        list
    }

    /// Adds a setting with the reference's target.
    fn add(&mut self, params: GenParams) {
        self.put(params, None);
    }

    /// Adds a setting with `extra` in its name, if given: it then has another target than the reference.
    fn put(&mut self, params: GenParams, extra: Option<String>) {
        let name = name_of(
            &PresetKnobs::from_params(&params),
            &PresetKnobs::from_params(&self.base),
        );
        if params.check().is_ok() && !self.settings.iter().any(|s| s.params == params) {
            self.settings.push(CandidateSetting {
                other_target: extra.is_some(),
                name: name + &extra.unwrap_or_default(),
                params,
            });
        }
    }

    /// Adds a setting in full precision and in int8.
    fn add_both_precisions(&mut self, params: GenParams) {
        self.add(params.clone());
        self.add(GenParams {
            precision: Precision::Int8,
            ..params.clone()
        });
    }

    /// Adds settings of one knob of edits after another: steps, solvers, fixed points, neighbours, reuse.
    fn add_knobs(&mut self) {
        let base = self.base.clone();
        for steps in [2, 4, 6, 10, 20, 33, 50] {
            self.add_both_precisions(GenParams {
                steps,
                ..base.clone()
            });
        }
        for steps in [4, 10, 20] {
            for solver in [SolverKind::DpmPp2M, SolverKind::UniPc, SolverKind::OBelm] {
                self.add(GenParams {
                    steps,
                    solver,
                    ..base.clone()
                });
            }
        }
        self.add(GenParams {
            inversion_iterations: 1,
            ..base.clone()
        });
        for steps in [4, 6, 10, 20, 33] {
            self.add_both_precisions(GenParams {
                steps,
                inversion_iterations: 3,
                ..base.clone()
            });
        }
        for halo_tokens in [0, 2, 4] {
            self.add(GenParams {
                halo_tokens,
                ..base.clone()
            });
        }
        for steps in [4, 10, 20] {
            self.add(GenParams {
                steps,
                local: false,
                ..base.clone()
            });
        }
        for reuse_steps in [2, 3] {
            for steps in [base.steps, 20] {
                self.add(GenParams {
                    reuse_steps,
                    steps,
                    ..base.clone()
                });
            }
        }
    }

    /// Adds the fine stage beside few and many steps.
    fn add_fine_stages(&mut self) {
        let base = self.base.clone();
        for steps in [2, 4, 10] {
            for fine_steps in [0, 1, 2, 8] {
                self.add(GenParams {
                    steps,
                    fine_steps,
                    ..base.clone()
                });
            }
        }
        for (steps, precision) in [(10, Precision::F32), (20, Precision::Int8)] {
            for fine_steps in [1, 4, 8] {
                self.add(GenParams {
                    steps,
                    precision,
                    fine_steps,
                    inversion_iterations: 3,
                    ..base.clone()
                });
            }
        }
    }

    /// Adds settings whose target is not that of the reference.
    fn add_other_targets(&mut self) {
        let base = self.base.clone();
        for guidance in [1.5, 3.0] {
            let extra = format!(", guidance {guidance}");
            self.put(
                GenParams {
                    guidance,
                    ..base.clone()
                },
                Some(extra),
            );
        }
        for halo_columns in [1, 4] {
            let extra = format!(", {halo_columns} columns around");
            self.put(
                GenParams {
                    halo_columns,
                    ..base.clone()
                },
                Some(extra),
            );
        }
    }

    /// Adds `draws` settings of a Latin hypercube.
    fn add_draws(&mut self, draws: usize, seed: u64) {
        let mut draw = Draw::new(seed, "hypercube");
        let mut columns: [Vec<usize>; 6] = std::array::from_fn(|_| (0..draws).collect());
        for column in &mut columns {
            for i in (1..draws).rev() {
                column.swap(i, draw.below(i + 1));
            }
        }
        // Chooses one of the knob's n values by the rank that was drawn.
        let pick = |knob: usize, i: usize, n: usize| columns[knob][i] * n / draws.max(1);
        for i in 0..draws {
            self.add(GenParams {
                steps: [3, 5, 8, 12, 16, 24][pick(0, i, 6)],
                solver: [SolverKind::Ddim, SolverKind::DpmPp2M, SolverKind::UniPc][pick(1, i, 3)],
                precision: [Precision::F32, Precision::Int8][pick(2, i, 2)],
                halo_tokens: [0, 1, 2][pick(3, i, 3)],
                inversion_iterations: [0, 0, 1][pick(4, i, 3)],
                reuse_steps: [1, 1, 2][pick(5, i, 3)],
                ..self.base.clone()
            });
        }
    }
}

/// The settings of edits: `base`, knobs one at a time, and `draws` random ones.
pub fn of_edits(base: GenParams, draws: usize, seed: u64) -> Vec<CandidateSetting> {
    let mut list = List::new(base);
    list.add_knobs();
    list.add_fine_stages();
    list.add_other_targets();
    list.add_draws(draws, seed);
    list.settings
}

/// The settings of whole scenes.
pub fn of_scenes(base: GenParams) -> Vec<CandidateSetting> {
    let mut list = List::new(base.clone());
    for steps in [4, 6, 10, 20, 40] {
        list.add_both_precisions(GenParams {
            steps,
            ..base.clone()
        });
    }
    for steps in [6, 10, 20] {
        list.add(GenParams {
            steps,
            solver: SolverKind::DpmPp2M,
            ..base.clone()
        });
        list.add(GenParams {
            steps,
            reuse_steps: 2,
            ..base.clone()
        });
    }
    for fine_steps in [0, 1, 2, 8] {
        list.add(GenParams {
            fine_steps,
            ..base.clone()
        });
    }
    list.settings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_sound_and_named_apart() {
        let settings = of_edits(GenParams::default(), 12, 3);
        assert!(settings.len() > 30);
        for (i, s) in settings.iter().enumerate() {
            assert_eq!(s.params.check(), Ok(()));
            let twin = settings[..i].iter().find(|t| t.name == s.name);
            assert!(twin.is_none(), "{}", s.name);
        }
        assert!(of_scenes(GenParams::default()).len() > 10);
    }
}
