use super::super::notation;
use super::super::reader::Mode;
use super::super::tokens::tokens;
use super::read;

fn check(mode: Mode, cases: &[(&str, &str)]) {
    for (text, line) in cases {
        let plain = read(&tokens(text, None), mode);
        let over: Vec<&str> = plain.left_over.iter().map(|s| s.of(text)).collect();
        assert_eq!(
            (notation::write(&plain.reading).as_str(), over),
            (*line, vec![]),
            "{text}"
        );
    }
}

#[test]
fn plain_prompts_are_read_to_the_last_word() {
    check(
        Mode::Prompt,
        &[
            (
                "Two parked cars and a bus ahead, at night.",
                "add 2 parked car and 1 bus ( ahead ego ) ; time night",
            ),
            (
                "A truck 20 m ahead of me in my lane",
                "add 1 truck ( ahead ego 20m ) ( on ego_lane )",
            ),
            (
                "three pedestrians on the crosswalk, no cars",
                "add 3 person ( on crossing ) ; no car",
            ),
            (
                "Foggy highway, a red van behind the bus",
                "weather fog ; road highway ; add 1 red van ( behind the bus )",
            ),
            (
                "a cyclist between two parked cars. Rain.",
                "add 1 bicycle ( between 2 parked car ) ; weather rain",
            ),
            (
                "A street with a zebra crossing in the rain. One pedestrian walks over the crossing, and a bus comes towards me 30 m ahead.",
                "has crossing ; weather rain ; add 1 person ( on crossing ) and 1 bus ( oncoming ego ) ( ahead ego 30m )",
            ),
            (
                "A car park by day. Three white cars are parked, and a barrier stands 12 m ahead of me.",
                "road parking ; time day ; add 3 parked white car and 1 barrier ( ahead ego 12m )",
            ),
            (
                "Show me two to four cones on the right, nothing else",
                "add 2 .. 4 cone ( right ego ) ; no other thing",
            ),
        ],
    );
}

#[test]
fn plain_edits_are_read_to_the_last_word() {
    check(
        Mode::Edit,
        &[
            (
                "put a worker behind each of the buses",
                "add 1 worker ( behind each bus )",
            ),
            ("remove each bus", "remove all bus"),
            ("Remove the bus", "remove the bus"),
            ("please take the two red cars away", "remove the 2 red car"),
            ("move the truck 5 metres closer", "move the truck by nearer 5m"),
            (
                "Put the bus 25 m ahead of me",
                "move the bus to ( ahead ego 25m )",
            ),
            (
                "paint the taxi blue and the rest stays",
                "set the taxi blue ; leave rest",
            ),
            (
                "add two cones behind the truck",
                "add 2 cone ( behind the truck )",
            ),
            ("replace the car with a bus", "replace the car with 1 bus"),
            ("the bus should be red", "set the bus red"),
            ("make it night", "time night"),
            ("keep only the bus and the truck", "keep the bus and the truck"),
            ("turn the car around", "turn the car around"),
            ("swap the bus and the truck", "swap the bus and the truck"),
            (
                "delete all cars except the red one",
                "remove all car ( except the red one )",
            ),
            ("one of the cones can go", "remove 1 cone"),
        ],
    );
}

#[test]
fn a_word_that_fits_nowhere_is_left_over() {
    let plain = read(&tokens("remove the bus gleefully", None), Mode::Edit);
    assert!(!plain.is_whole());
}
