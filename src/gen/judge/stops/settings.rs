//! The settings that are tried: the default, each knob by itself, and random ones across all knobs (a Latin hypercube:
//! every knob's values occur equally often).

use diffusion::solver::SolverKind;
use job::{GenParams, Precision};
use trade::StopKnobs;
use world::draw::Draw;

/// A setting with a name.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The knobs that differ from the default: `steps 4, int8`.
    pub name: String,
    /// All parameters.
    pub params: GenParams,
    /// It asks for another result than the reference: how far it lies from that is no error of its numerics.
    pub other_target: bool,
}

/// What the knobs are called where they differ from `base`.
pub fn name_of(knobs: &StopKnobs, base: &StopKnobs) -> String {
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

/// The settings of edits: `base`, knobs one at a time, and `draws` random ones.
pub fn of_edits(base: GenParams, draws: usize, seed: u64) -> Vec<Setting> {
    let mut out: Vec<Setting> = Vec::new();
    let mut add = |params: GenParams, other_target: bool, extra: &str| {
        let name = name_of(&StopKnobs::of(&params), &StopKnobs::of(&base)) + extra;
        if params.check().is_ok() && !out.iter().any(|s| s.params == params) {
            out.push(Setting {
                name,
                params,
                other_target,
            });
        }
    };
    add(base, false, "");
    for steps in [2, 4, 6, 10, 20, 33, 50] {
        add(GenParams { steps, ..base }, false, "");
        let precision = Precision::Int8;
        add(
            GenParams {
                steps,
                precision,
                ..base
            },
            false,
            "",
        );
    }
    for steps in [4, 10, 20] {
        for solver in [SolverKind::DpmPp2M, SolverKind::UniPc, SolverKind::OBelm] {
            add(
                GenParams {
                    steps,
                    solver,
                    ..base
                },
                false,
                "",
            );
        }
    }
    add(
        GenParams {
            inversion_iterations: 1,
            ..base
        },
        false,
        "",
    );
    for steps in [4, 6, 10, 20, 33] {
        let inversion_iterations = 3;
        add(
            GenParams {
                steps,
                inversion_iterations,
                ..base
            },
            false,
            "",
        );
        let precision = Precision::Int8;
        add(
            GenParams {
                steps,
                inversion_iterations,
                precision,
                ..base
            },
            false,
            "",
        );
    }
    for halo_tokens in [0, 2, 4] {
        add(GenParams { halo_tokens, ..base }, false, "");
    }
    for steps in [4, 10, 20] {
        add(
            GenParams {
                steps,
                local: false,
                ..base
            },
            false,
            "",
        );
    }
    for reuse_steps in [2, 3] {
        add(GenParams { reuse_steps, ..base }, false, "");
        add(
            GenParams {
                reuse_steps,
                steps: 20,
                ..base
            },
            false,
            "",
        );
    }
    for steps in [2, 4, 10] {
        for fine_steps in [0, 1, 2, 8] {
            add(
                GenParams {
                    steps,
                    fine_steps,
                    ..base
                },
                false,
                "",
            );
        }
    }
    for (steps, precision) in [(10, Precision::F32), (20, Precision::Int8)] {
        for fine_steps in [1, 4, 8] {
            add(
                GenParams {
                    steps,
                    precision,
                    fine_steps,
                    inversion_iterations: 3,
                    ..base
                },
                false,
                "",
            );
        }
    }
    for guidance in [1.5, 3.0] {
        add(
            GenParams { guidance, ..base },
            true,
            &format!(", guidance {guidance}"),
        );
    }
    for halo_columns in [1, 4] {
        add(
            GenParams { halo_columns, ..base },
            true,
            &format!(", {halo_columns} columns around"),
        );
    }
    let mut draw = Draw::new(seed, "hypercube");
    let mut columns: [Vec<usize>; 6] = std::array::from_fn(|_| (0..draws).collect());
    for column in &mut columns {
        for i in (1..draws).rev() {
            column.swap(i, draw.below(i + 1));
        }
    }
    // Value i of n of a knob for the rank that the draw gave.
    let pick = |knob: usize, i: usize, n: usize| columns[knob][i] * n / draws.max(1);
    for i in 0..draws {
        add(
            GenParams {
                steps: [3, 5, 8, 12, 16, 24][pick(0, i, 6)],
                solver: [SolverKind::Ddim, SolverKind::DpmPp2M, SolverKind::UniPc][pick(1, i, 3)],
                precision: [Precision::F32, Precision::Int8][pick(2, i, 2)],
                halo_tokens: [0, 1, 2][pick(3, i, 3)],
                inversion_iterations: [0, 0, 1][pick(4, i, 3)],
                reuse_steps: [1, 1, 2][pick(5, i, 3)],
                ..base
            },
            false,
            "",
        );
    }
    out
}

/// The settings of whole scenes.
pub fn of_scenes(base: GenParams) -> Vec<Setting> {
    let mut out: Vec<Setting> = Vec::new();
    let mut add = |params: GenParams| {
        let name = name_of(&StopKnobs::of(&params), &StopKnobs::of(&base));
        if !out.iter().any(|s| s.params == params) {
            out.push(Setting {
                name,
                params,
                other_target: false,
            });
        }
    };
    add(base);
    for steps in [4, 6, 10, 20, 40] {
        add(GenParams { steps, ..base });
        add(GenParams {
            steps,
            precision: Precision::Int8,
            ..base
        });
    }
    for steps in [6, 10, 20] {
        add(GenParams {
            steps,
            solver: SolverKind::DpmPp2M,
            ..base
        });
        add(GenParams {
            steps,
            reuse_steps: 2,
            ..base
        });
    }
    for fine_steps in [0, 1, 2, 8] {
        add(GenParams { fine_steps, ..base });
    }
    out
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
