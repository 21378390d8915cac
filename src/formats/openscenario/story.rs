//! Where everybody is at the start, and where they go.

use std::fmt::Write as _;

use glam::{DVec2, DVec3, EulerRot};

use super::entities::{Actor, Who};
use crate::xml_text::number;
use scene::{Clip, Scene, SceneBox};

/// A scene that stands still is played for this long, s: its boxes have speeds to begin with.
const STILL_S: f64 = 10.0;

/// Pose of a participant's reference point.
#[derive(Clone, Copy, PartialEq)]
struct ActorPose {
    at_m: DVec3,
    /// Heading, pitch and roll about z, y and x, rad.
    turn_rad: [f64; 3],
}

/// Place of a participant at a time, and its speed along the heading, m/s; `None` while it is not there.
fn place(scene: &Scene, actor: &Actor, time_s: f64) -> Option<(ActorPose, f64)> {
    let (clip, canvas) = (scene.clip(), scene.canvas());
    let relief = &canvas.layout.relief;
    let of_box = |b: &SceneBox| {
        let h = b.heading();
        let ahead = h * actor.center_m.x + h.perp() * actor.center_m.y;
        let at_m = b.center_m - ahead.extend(actor.center_m.z);
        let place = ActorPose {
            at_m,
            turn_rad: [wrapped(b.yaw_rad), 0.0, 0.0],
        };
        (place, b.velocity_mps.dot(h))
    };
    match actor.who {
        Who::Standing(id) => canvas.boxes.get(&id).map(of_box),
        Who::Moving(id) => clip.box_at(id, time_s, relief).as_ref().map(of_box),
        Who::Ego => {
            let pose = clip.ego_at(time_s, &canvas.world_from_ego, relief);
            let (heading, pitch, roll) = pose.rotation.to_euler(EulerRot::ZYX);
            let ahead = (pose.rotation * DVec3::X).truncate().normalize_or(DVec2::X);
            let speed_mps = match clip.ego_moving(time_s) {
                Some(moving) => moving.velocity_mps.dot(ahead),
                None if clip.stands() => scene.rig.ego_speed_mps,
                None => 0.0,
            };
            let place = ActorPose {
                at_m: pose.translation_m,
                turn_rad: [heading, pitch, roll],
            };
            Some((place, speed_mps))
        }
    }
}

fn wrapped(rad: f64) -> f64 {
    (rad + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

impl ActorPose {
    fn element(&self) -> String {
        let [h, p, r] = self.turn_rad.map(number);
        format!(
            "<Position><WorldPosition x=\"{}\" y=\"{}\" z=\"{}\" h=\"{h}\" p=\"{p}\" r=\"{r}\"/></Position>",
            number(self.at_m.x),
            number(self.at_m.y),
            number(self.at_m.z),
        )
    }
}

/// The frames of a clip at which a participant is there, with its places. Between the first and the last, a frame is
/// left out if the place is the same before and behind it.
fn trajectory(scene: &Scene, actor: &Actor) -> Vec<(f64, ActorPose, f64)> {
    let clip = scene.clip();
    let all = (0..clip.frames()).filter_map(|frame| {
        let time_s = clip.time_of(frame);
        place(scene, actor, time_s).map(|(place, speed)| (time_s, place, speed))
    });
    let mut out: Vec<(f64, ActorPose, f64)> = Vec::new();
    for here in all {
        let n = out.len();
        if n >= 2 && out[n - 1].1 == here.1 && out[n - 2].1 == here.1 {
            out[n - 1] = here;
        } else {
            out.push(here);
        }
    }
    out
}

fn moves(scene: &Scene, actor: &Actor) -> bool {
    match actor.who {
        Who::Ego => scene.clip().ego.is_some(),
        Who::Moving(_) => true,
        Who::Standing(_) => false,
    }
}

/// The first place of everybody, and the speed there. Who comes later waits there, not to be seen.
pub(super) fn init(out: &mut String, scene: &Scene, actors: &[Actor]) {
    for actor in actors {
        let first = match moves(scene, actor) {
            true => trajectory(scene, actor).first().copied(),
            false => place(scene, actor, 0.0).map(|(place, speed)| (0.0, place, speed)),
        };
        // A participant that is at no frame of the clip gets no place.
        let Some((time_s, place, speed_mps)) = first else {
            continue;
        };
        let _ = writeln!(
            out,
            "        <Private entityRef=\"{}\">\n          <PrivateAction><TeleportAction>{}</TeleportAction></PrivateAction>\n          \
             <PrivateAction><LongitudinalAction><SpeedAction><SpeedActionDynamics dynamicsShape=\"step\" \
             dynamicsDimension=\"time\" value=\"0\"/><SpeedActionTarget><AbsoluteTargetSpeed value=\"{}\"/></SpeedActionTarget>\
             </SpeedAction></LongitudinalAction></PrivateAction>",
            actor.name,
            place.element(),
            number(speed_mps),
        );
        if time_s > 0.0 {
            let _ = writeln!(out, "          <PrivateAction>{}</PrivateAction>", shown(false));
        }
        out.push_str("        </Private>\n");
    }
}

/// An action that shows or hides a participant.
fn shown(is_there: bool) -> String {
    format!("<VisibilityAction graphics=\"{is_there}\" sensors=\"{is_there}\" traffic=\"{is_there}\"/>")
}

/// A trigger at a time of the simulation.
fn at_time(name: &str, tag: &str, time_s: f64) -> String {
    format!(
        "<{tag}><ConditionGroup><Condition name=\"{name}\" delay=\"0\" conditionEdge=\"none\"><ByValueCondition>\
         <SimulationTimeCondition value=\"{}\" rule=\"greaterOrEqual\"/></ByValueCondition></Condition></ConditionGroup></{tag}>",
        number(time_s)
    )
}

/// One trajectory for everybody who moves.
pub(super) fn story(out: &mut String, scene: &Scene, actors: &[Actor]) {
    let clip = scene.clip();
    let paths = actors.iter().filter(|a| moves(scene, a));
    let paths = paths.map(|actor| (actor, trajectory(scene, actor)));
    let paths: Vec<_> = paths.filter(|(_, path)| path.len() >= 2).collect();
    if paths.is_empty() {
        return;
    }
    out.push_str("    <Story name=\"clip\">\n      <ParameterDeclarations/>\n      <Act name=\"clip\">\n");
    let last_s = clip.time_of(clip.frames() - 1);
    for (actor, path) in &paths {
        let name = &actor.name;
        let (first_s, until_s) = (path[0].0, path[path.len() - 1].0);
        let _ = writeln!(
            out,
            "        <ManeuverGroup name=\"{name}\" maximumExecutionCount=\"1\">\n          \
             <Actors selectTriggeringEntities=\"false\"><EntityRef entityRef=\"{name}\"/></Actors>\n          \
             <Maneuver name=\"{name}\">"
        );
        if first_s > 0.0 {
            visibility(out, name, "appears", first_s, true);
        }
        follow(out, name, path);
        if until_s < last_s {
            visibility(out, name, "leaves", until_s + 1.0 / clip.rate_hz, false);
        }
        out.push_str("          </Maneuver>\n        </ManeuverGroup>\n");
    }
    let _ = writeln!(
        out,
        "        {}\n      </Act>\n    </Story>",
        at_time("start of the clip", "StartTrigger", 0.0)
    );
}

fn visibility(out: &mut String, name: &str, what: &str, time_s: f64, is_there: bool) {
    let _ = writeln!(
        out,
        "            <Event name=\"{name} {what}\" priority=\"parallel\" maximumExecutionCount=\"1\">\n              \
         <Action name=\"{name} {what}\"><PrivateAction>{}</PrivateAction></Action>\n              {}\n            </Event>",
        shown(is_there),
        at_time(&format!("{name} {what}"), "StartTrigger", time_s),
    );
}

fn follow(out: &mut String, name: &str, path: &[(f64, ActorPose, f64)]) {
    let _ = writeln!(
        out,
        "            <Event name=\"{name} moves\" priority=\"parallel\" maximumExecutionCount=\"1\">\n              \
         <Action name=\"{name} moves\">\n                <PrivateAction><RoutingAction><FollowTrajectoryAction>\n                  \
         <TrajectoryRef><Trajectory name=\"{name}\" closed=\"false\"><ParameterDeclarations/><Shape><Polyline>"
    );
    for (time_s, place, _) in path {
        let _ = writeln!(
            out,
            "                    <Vertex time=\"{}\">{}</Vertex>",
            number(*time_s),
            place.element()
        );
    }
    let _ = writeln!(
        out,
        "                  </Polyline></Shape></Trajectory></TrajectoryRef>\n                  \
         <TimeReference><Timing domainAbsoluteRelative=\"absolute\" scale=\"1\" offset=\"0\"/></TimeReference>\n                  \
         <TrajectoryFollowingMode followingMode=\"position\"/>\n                \
         </FollowTrajectoryAction></RoutingAction></PrivateAction>\n              </Action>\n              {}\n            </Event>",
        at_time(&format!("{name} moves"), "StartTrigger", path[0].0),
    );
}

/// The end of the clip.
pub(super) fn stop(out: &mut String, clip: &Clip) {
    let end_s = if clip.length_s > 0.0 {
        clip.length_s
    } else {
        STILL_S
    };
    let _ = writeln!(out, "    {}", at_time("end of the clip", "StopTrigger", end_s));
}
