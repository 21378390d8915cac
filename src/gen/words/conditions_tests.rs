//! Sentences about time and weather: the same conditions as the text of a scene and as a style, and pictures as bright as
//! they say.

use super::super::carry_out::carry_out;
use super::super::describe::describe;
use super::super::hear::hear;
use super::super::reader::Mode;
use super::super::stage::OpenScene;
use super::*;
use scene::{Edit, Frame, SensorRig};
use sensors::pictures::appearance::{Appearance, Quality};
use world::World;
use world::voxelize::{Vertical, complete};

use TimeOfDay::{Dawn, Day, Dusk, Night};
use Weather::{Clear, Fog, Overcast, Rain, Sandstorm, Snow};

const SENTENCES: [(&str, TimeOfDay, Weather); 28] = [
    ("sleet after nightfall", Night, Rain),
    ("it is no longer raining", Day, Clear),
    ("sleet", Day, Rain),
    ("drizzle in the morning", Dawn, Rain),
    ("fog", Day, Fog),
    ("overcast", Day, Overcast),
    ("dusk", Dusk, Clear),
    ("dawn", Dawn, Clear),
    ("not raining", Day, Clear),
    ("without fog", Day, Clear),
    ("dry road after the rain", Day, Clear),
    ("midnight", Night, Clear),
    ("snow", Day, Snow),
    ("no snow, overcast at dusk", Dusk, Overcast),
    ("a clear night", Night, Clear),
    ("the rain has stopped", Day, Clear),
    ("it isn't foggy any more", Day, Clear),
    ("neither rain nor snow at noon", Day, Clear),
    ("night without rain", Night, Clear),
    ("a sandstorm at noon", Day, Sandstorm),
    ("not a rainy night", Night, Clear),
    ("no rain or fog", Day, Clear),
    ("a street at night, it stopped raining", Night, Clear),
    ("foggy after rain", Day, Fog),
    ("day, no rain, cloudy", Day, Overcast),
    ("pouring down after midnight", Night, Rain),
    ("heavy snowfall at sunset", Dusk, Snow),
    ("two cars, but no rain", Day, Clear),
];

/// Mean of red, green and blue of what the front camera sees of a street.
fn brightness(frame: &Frame, rig: &SensorRig, conditions: Conditions) -> f64 {
    let appearance = Appearance::new(frame, rig, &conditions);
    let image = appearance.render(&rig.cameras[0], 48, 27, Quality::Preview);
    let rgb = image.rgba.chunks_exact(4).flat_map(|p| &p[..3]);
    let (sum, n) = rgb.fold((0.0, 0.0), |(s, n), v| (s + f64::from(*v), n + 1.0));
    sum / n
}

#[test]
fn a_sentence_gives_the_same_conditions_as_scene_and_as_style() {
    let world = World::random(5);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    let mut rig = SensorRig::default();
    rig.cameras.truncate(1);
    let bright = |c| brightness(&frame, &rig, c);
    let day = bright(Conditions::default());
    for (text, time, weather) in SENTENCES {
        let expected = Conditions::usual(time, weather, 7);
        assert_eq!(of_style(text, 7), expected, "style: {text}");
        let heard = hear(text, Mode::Prompt).expect("weights");
        let found = describe(&heard.reading).description.conditions(7);
        assert_eq!(found, expected, "scene: {text}");
        let light = bright(found) / day;
        match time {
            Night => assert!(light < 0.5, "{text}: {light} of a clear day"),
            _ => assert!(light > 0.55, "{text}: {light} of a clear day"),
        }
    }
}

#[test]
fn edits_by_words_set_the_conditions() {
    let world = World::random(5);
    let after = |text: &str, conditions: Conditions| {
        let heard = hear(text, Mode::Edit).expect("weights");
        let scene = OpenScene {
            boxes: &world.boxes,
            layout: &world.layout,
            prompt: "night, rain, downtown",
            conditions,
            clip: None,
            ego_moves: false,
            length_s: 0.0,
        };
        let edits = carry_out(&heard.reading, &scene, 1).edits;
        let set = edits.iter().rev().find_map(|e| match e {
            Edit::SetConditions { conditions } => Some(*conditions),
            _ => None,
        });
        let style = edits.iter().rev().find_map(|e| match e {
            Edit::SetPrompt { prompt } => Some(prompt.clone()),
            _ => None,
        });
        (set, style)
    };
    let rain = Conditions::usual(Day, Rain, 9);
    let damp = Conditions { wetness: 0.4, ..rain };
    assert_eq!(after("make it night", damp).0, Some(damp.at(Night)));
    let night = Conditions::usual(Night, Rain, 9);
    for text in [
        "no more rain",
        "it is no longer raining",
        "without rain",
        "stop the rain",
    ] {
        let (set, style) = after(text, night);
        assert_eq!(set, Some(night.under(Clear)), "{text}");
        assert_eq!(style.as_deref(), Some("night, clear, downtown"), "{text}");
    }
    let (set, _) = after("make it a foggy morning", night);
    assert_eq!(set, Some(night.at(Dawn).under(Fog)));
    assert_eq!(after("make it night", night), (None, None), "it is night already");
}

/// Words of paint, and people who stopped in some weather, do not change the weather.
#[test]
fn what_only_looks_like_weather() {
    let of = |text: &str| {
        let said = read(text);
        (said.time, said.weather)
    };
    assert_eq!(of("a grey van"), (None, None));
    assert_eq!(of("a dark red car at noon"), (Some(Day), None));
    assert_eq!(of("a bus that stopped in the rain"), (None, Some(Rain)));
    assert_eq!(of("shortly after dusk").0, Some(Dusk));
    assert_eq!(of("a training run; Saturday; 夜 \u{0}"), (None, None));
    assert_eq!(of(""), (None, None));
    for time in TimeOfDay::ALL {
        assert_eq!(of(time.name()).0, Some(time));
        for weather in Weather::ALL {
            let text = format!("busy market, {}, red cars, {}", time.name(), weather.name());
            assert_eq!(of(&text), (Some(time), Some(weather)));
        }
    }
}
