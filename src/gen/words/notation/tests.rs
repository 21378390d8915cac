use super::{parse, write};

#[test]
fn readings_survive_writing_and_json() {
    for line in [
        "add 2 parked red car ( on right_roadside ) and 1 bus",
        "add 2 .. 4 person ( between the bus and 1 car ( left ego ) ) ; time night",
        "no other thing ; leave rest",
        "remove the 2 farthest cone ; keep all not_red car ( except the taxi ) and it",
        "replace all truck with some bus ( like the woman )",
        "move the truck #7 to ( ahead ego 12.5m ) ( on ego_lane )",
        "move the bus by nearer 3m ; move it by lane_right 2 ; move it by times 0.5",
        "turn the nth 0 car right 45deg ; turn half car left ; turn all other bus to ( oncoming ego )",
        "set the car large parked red ; set 1 truck paint_of the bus",
        "count cone to 2 .. 4 ; count bicycle times 2 ; swap the car and the bus",
        "has crossing ( ahead ego 20m ) ; lacks sidewalk ; lanes 4 ; one_way ; narrow ; own_lane left ; road t_junction",
        "go the car cut_in from 2s ; go ego drive speed 48.3kmh ; go all bus pull_out gap 10m slow ; length 12s",
        "add many cone ( in_line ) ; add 2 bus ( facing each_other ) ; move the bus to ( on other_side ) ( there )",
    ] {
        let reading = parse(line).unwrap_or_else(|e| panic!("{line}: {e}"));
        assert_eq!(write(&reading), line);
        let json = serde_json::to_string(&reading).expect("values");
        assert_eq!(
            serde_json::from_str::<super::super::reading::Reading>(&json).expect("the same"),
            reading,
            "{json}"
        );
    }
}

#[test]
fn what_is_no_reading_is_refused_with_its_place() {
    for (line, found) in [
        ("remove", ""),
        ("add 2 flying car", "flying"),
        ("move the bus", ""),
        ("set the bus", ""),
        ("add 1 car ( on", ""),
        ("add 1 car ( at ego )", ")"),
        ("dance", "dance"),
        ("go the car", ""),
        ("go the car fly", "fly"),
        ("go ego stop from 3m", "3m"),
        ("length 10", "10"),
        ("time noon", "noon"),
        ("add 99999999999 car", "99999999999"),
    ] {
        let error = parse(line).expect_err(line);
        assert_eq!(error.found, found, "{line}: {error}");
        assert!(!error.to_string().contains('\n'));
    }
    let deep = "add 1 car ( behind 1 car ".repeat(5000);
    assert!(parse(&deep).is_err());
}
