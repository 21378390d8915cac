//! One word for one thing: what has many names is called by its commonest before any turn of speech is looked for, since
//! turns of speech are known by their words. Spans stay, so that the reader is told of his own words.

use super::lexicon::{Sense, look_up};
use super::said::words::{is_unit, longest, noun_at, number};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};

/// Things: the word that stands for them, and their other names, which say no more. Plurals follow by their own lists.
const THINGS: &[(&str, &str)] = &[
    (
        "car",
        "automobile|motorcar|motor car|passenger car|private car|passenger automobile|motor automobile",
    ),
    (
        "cars",
        "automobiles|motorcars|motor cars|passenger cars|private cars|passenger automobiles",
    ),
    (
        "truck",
        "lorry|hgv|heavy goods vehicle|goods vehicle|goods lorry|heavy lorry|heavy truck|goods truck",
    ),
    (
        "trucks",
        "lorries|hgvs|heavy goods vehicles|goods vehicles|goods lorries|heavy lorries|heavy trucks",
    ),
    ("bus", "omnibus|motor coach|motorcoach|motor bus|autobus"),
    (
        "buses",
        "omnibuses|motor coaches|motorcoaches|motor buses|autobuses|busses",
    ),
    (
        "pedestrian",
        "passer by|passerby|foot passenger|foot traveller|person on foot|somebody on foot|someone on foot",
    ),
    ("people", "ppl"),
    ("give me", "gimme"),
    (
        "pedestrians",
        "passers by|passersby|foot passengers|persons on foot|people on foot",
    ),
    (
        "cyclist",
        "bicyclist|pedal cyclist|push bike rider|pushbike rider|velocipedist|bike rider|bicycle rider|cycle rider|rider on a bicycle|rider on a bike|person on a bike|\
         person on a bicycle|man on a bike|man on a bicycle|woman on a bike|woman on a bicycle|someone on a bike|someone on a bicycle|\
         somebody on a bike|somebody on a bicycle|person cycling|man cycling|woman cycling|child cycling|person on a pushbike|person riding a bike|person riding a bicycle",
    ),
    (
        "a cyclist",
        "somebody cycling|someone cycling|somebody riding a bike|someone riding a bike|somebody riding a bicycle|someone riding a bicycle|somebody riding a pushbike|\
         somebody on a pushbike|someone on a pushbike|somebody who cycles|someone who cycles|somebody who is cycling|someone who is cycling",
    ),
    (
        "a motorcyclist",
        "somebody riding a motorbike|someone riding a motorbike|somebody riding a motorcycle|someone riding a motorcycle|somebody riding a scooter|someone riding a scooter|\
         somebody riding a moped|someone riding a moped",
    ),
    (
        "cyclists",
        "bicyclists|pedal cyclists|push bike riders|bike riders|bicycle riders|riders on bicycles|riders on bikes|people on bikes|people on bicycles|\
         persons on bikes|persons on bicycles",
    ),
    (
        "motorcyclist",
        "rider on a motorcycle|rider on a motorbike|person on a motorcycle|person on a motorbike|man on a motorcycle|man on a motorbike|\
         someone on a motorbike|someone on a motorcycle|woman on a motorbike|woman on a motorcycle|motorbike rider|motorcycle rider",
    ),
    (
        "cone",
        "traffic cone|road cone|safety cone|marker cone|warning cone|traffic pylon|road pylon|safety pylon|pylon|construction cone",
    ),
    (
        "cones",
        "traffic cones|road cones|safety cones|marker cones|warning cones|traffic pylons|road pylons|safety pylons|pylons|construction cones",
    ),
    (
        "barrier",
        "barricade|road barrier|traffic barrier|crash barrier|safety barrier|traffic barricade|road barricade",
    ),
    (
        "barriers",
        "barricades|road barriers|traffic barriers|crash barriers|safety barriers|traffic barricades|road barricades",
    ),
    (
        "sidewalk",
        "footway|footpath|walkway|pedestrian path|pedestrian walkway|kerbside path|curbside path|walking path|side walk|sideway|pedestrian pavement|\
         pedestrian footpath|foot path|trottoir",
    ),
    (
        "sidewalks",
        "footways|footpaths|walkways|pedestrian paths|pedestrian walkways|side walks|foot paths|pavements",
    ),
    (
        "crosswalk",
        "pedestrian crosswalk|pedestrian zebra|zebra crosswalk|cross walk|zebra stripes|crossing stripes|zebra markings|striped crossing",
    ),
    (
        "oncoming lane",
        "opposite lane|opposing lane|opposing traffic lane|opposite traffic lane|opposite driving lane|oncoming traffic lane|lane of the oncoming traffic|lane of oncoming traffic|\
         lane for oncoming traffic|lane for the oncoming traffic|lane of opposing traffic|lane of the opposing traffic|lane coming towards us|\
         lane coming towards me|lane coming the other way|lane going the other way|lane in the opposite direction|lane in the other direction|\
         lane of the opposite direction|lane for the opposite direction|contraflow lane|counter lane|lane for opposing traffic|lane coming toward us|\
         lane across from ours|lane across from our own|lane across from our lane|lane opposite ours|lane opposite our own|lane opposite to ours|\
         lane opposite of ours|lane opposite our lane|lane facing ours|lane on the other side from ours|lane on the far side of ours|lane that runs against ours|\
         lane beyond the centre line|lane beyond the center line|lane over the centre line|lane over the center line|lane on the other side of the centre line|\
         lane on the other side of the center line|lane on the other side of the road|lane on the other side of the street|lane on the far side of the road|\
         lane on the opposite side of the road|lane on the opposite side of the street",
    ),
];

/// Our lane, with the article that goes with it.
const OUR_LANE: &str = "the ego vehicles lane|the ego vehicle lane|the ego cars lane|the ego car lane|the players lane|the player lane|the egos lane|the ego lane|ego lane|the lane of the ego vehicle|the lane of the ego car|\
    the lane of the ego|the lane of our car|the lane of my car|the lane i drive in|the lane we drive in|the lane that i drive in|the lane that we drive in|\
    the lane im in|the lane i am in|the lane were in|the lane we are in|the lane that we are in|the lane that i am in|the lane i am driving in|\
    the lane im driving in|the lane we are driving in|the lane were driving in|the lane that we are driving in|the lane that i am driving in|\
    our own lane|my own lane|our driving lane|my driving lane|our traffic lane|my traffic lane|our travel lane|my travel lane|the lane of ours|\
    the same lane as us|the same lane as me|the same lane as the ego|the same lane as the ego vehicle|the lane we use|the lane i use|our very lane";

/// Behind us and before us, in which several words stand for one relation to the ego vehicle.
const BEHIND_US: &str = "on the players tail|on the player tail|on the tail of the ego|on our tail|on my tail|behind the player|in our rear|in my rear|to our rear|to my rear|at our rear|at my rear|at our back|at my back|in our back|in back of us|in back of me|\
    to the rear of us|to the rear of me|in the rear of us|at the rear of us|at the back of us|rearward of us|rearwards of us|behind our car|behind my car|\
    behind our vehicle|behind my vehicle|behind the ego vehicle|behind the ego car|behind the ego|behind our own car|behind my own car";
const AHEAD_OF_US: &str = "in front of the player|ahead of the player|in front of our car|in front of my car|in front of our vehicle|in front of my vehicle|in front of the ego vehicle|\
    in front of the ego car|in front of the ego|ahead of our car|ahead of my car|ahead of our vehicle|ahead of my vehicle|ahead of the ego vehicle|\
    ahead of the ego car|ahead of the ego|forward of us|forward of me|forward of the ego|before us|before me|before the ego|before our car|before my car";

const BEHIND: &str = "in back of|to the rear of|in the rear of|on the rear side of|to the rear side of|at the rear side of|at the back side of|rearward of|rearwards of|\
    in rear of|aft of|on the back side of";
const IN_FRONT: &str = "forward of|on the front side of|at the front side of|to the front side of";
const AHEAD: &str = "up ahead|up the road|up the street|down the road|down the street|out front|to the front|up front|in front of here";

/// What only says that a length is no exact one, or is.
const ABOUT: &str = "about|approximately|roughly|around|circa|ca|some|a good|nearly|almost|exactly|precisely|more or less|something like|say|approx|around about";

/// Several that are counted as one.
const SEVERAL: &[(&str, &str)] = &[
    ("two", "a pair of|a couple of|a duo of|a brace of"),
    ("three", "a trio of|a threesome of"),
    ("four", "a quartet of|a foursome of"),
];
/// What groups so many without saying more: "a bunch of three cyclists", "three pieces of fencing".
const GROUP_OF: &str =
    "a bunch of|a group of|a set of|a handful of|a cluster of|a pack of|a gang of|a party of";
const NUMBERS: [&str; 11] = [
    "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
];

/// What may go before a compound that ends in one of [`THINGS`] and is another thing then: "tanker lorry".
fn in_compound(tokens: &[Token], i: usize, n: usize) -> bool {
    let noun = |from: usize, to: usize| {
        let run = &tokens[from..to];
        let words: Vec<&str> = run.iter().map(|t| t.text.as_str()).collect();
        run.iter().all(|t| t.kind == TokenKind::Word)
            && matches!(
                look_up(&words.join(" ")),
                Some(Sense::Noun(..) | Sense::Place(..))
            )
    };
    let before = (1..=2.min(i)).any(|k| noun(i - k, i + n));
    let after = (1..=2).any(|k| i + n + k <= tokens.len() && noun(i, i + n + k));
    before || after
}

fn after_length(tokens: &[Token], i: usize) -> bool {
    i >= 2 && is_unit(tokens.get(i - 1)) && number(&tokens[i - 2]).is_some()
}

/// "before the bus", when it is no clause: "before the bus comes".
fn before_a_thing(tokens: &[Token], i: usize) -> bool {
    let the = |t: &Token| matches!(t.text.as_str(), "the" | "that" | "my" | "our" | "a" | "an");
    if tokens[i].text != "before" || !tokens.get(i + 1).is_some_and(the) {
        return false;
    }
    let Some(n) = tokens.get(i + 2..).and_then(noun_at) else {
        return false;
    };
    tokens.get(i + 2 + n).is_none_or(|t| {
        matches!(t.kind, TokenKind::Stop | TokenKind::Comma) || matches!(t.text.as_str(), "and" | "but")
    })
}

/// "an oncoming bus 28 m away": what comes towards us is ahead of us.
fn comes_from_there(tokens: &[Token], i: usize) -> bool {
    if !matches!(tokens[i].text.as_str(), "away" | "off") || !after_length(tokens, i) {
        return false;
    }
    let ends = tokens
        .get(i + 1)
        .is_none_or(|t| t.kind != TokenKind::Word || matches!(t.text.as_str(), "and" | "from" | "in"));
    let from_us = tokens.get(i + 1).is_none_or(|t| t.text != "from");
    let clause = tokens[..i]
        .iter()
        .rposition(|t| t.kind == TokenKind::Stop || t.text == "and")
        .map_or(0, |k| k + 1);
    let said = &tokens[clause..i];
    let comes = (0..said.len()).any(|k| {
        begins(
            &said[k..],
            "coming towards us|coming towards me|comes towards us|comes towards me|coming toward us",
        )
        .is_some()
            || said[k].text == "oncoming"
                && said
                    .get(k + 1)
                    .is_some_and(|t| t.text != "lane" && t.text != "traffic")
    });
    let step = said.iter().any(|t| {
        matches!(
            t.text.as_str(),
            "move" | "push" | "shift" | "send" | "bring" | "drive" | "by" | "further" | "farther"
        )
    });
    ends && from_us && comes && !step
}

/// A text in which each thing, side and number has one name.
pub fn plain(tokens: &[Token]) -> Vec<Token> {
    let out = rewritten(tokens, |i, out| {
        let rest = &tokens[i..];
        // "swap the car 4 a bus"
        let four = matches!(rest[0].kind, TokenKind::Number(4.0))
            && rest.get(1).is_some_and(|t| matches!(t.text.as_str(), "a" | "an"))
            && i > 0
            && tokens[i - 1].kind == TokenKind::Word;
        if four {
            out.push(word("for", &rest[0]));
            return Some(i + 1);
        }
        let put = |out: &mut Vec<Token>, words: &str| {
            out.extend(words.split(' ').map(|w| word(w, &tokens[i])));
        };
        if let Some(n) = begins(rest, OUR_LANE) {
            put(out, "our lane");
            return Some(i + n);
        }
        for (name, others) in THINGS {
            if let Some(n) = begins(rest, others).filter(|n| !in_compound(tokens, i, *n)) {
                put(out, name);
                return Some(i + n);
            }
        }
        for (name, others) in SEVERAL {
            let of_these = i > 0 && matches!(tokens[i - 1].text.as_str(), "the" | "this" | "that");
            let Some(n) = begins(rest, others) else { continue };
            let own = tokens
                .get(i + n)
                .is_some_and(|t| t.kind == TokenKind::Word && number(t).is_none());
            if own
                && !of_these
                && tokens
                    .get(i + n)
                    .is_some_and(|t| t.text != "the" && t.text != "them")
            {
                put(out, name);
                return Some(i + n);
            }
        }
        None
    });
    sides(&numbers(&out))
}

/// Sides of the ego vehicle and of things.
fn sides(tokens: &[Token]) -> Vec<Token> {
    // "two in front of our car and one behind it": what "it" points at keeps its name
    let pointed_at = |i: usize| {
        tokens[i..]
            .iter()
            .take(16)
            .any(|t| matches!(t.text.as_str(), "it" | "its"))
    };
    rewritten(tokens, |i, out| {
        let rest = &tokens[i..];
        let (words, n) = if let Some(n) = begins(rest, BEHIND_US) {
            ("behind us", n)
        } else if let Some(n) = begins(rest, AHEAD_OF_US) {
            ("ahead of us", n)
        } else if let Some(n) = begins(rest, BEHIND) {
            ("behind", n)
        } else if let Some(n) = begins(rest, IN_FRONT) {
            ("in front of", n)
        } else if before_a_thing(tokens, i) {
            ("in front of", 1)
        } else if comes_from_there(tokens, i) {
            ("ahead", 1)
        } else {
            let n = begins(rest, AHEAD)?;
            let goes_on = tokens
                .get(i + n)
                .is_some_and(|t| matches!(t.text.as_str(), "of" | "from" | "than" | "towards" | "to"));
            if goes_on || !after_length(tokens, i) {
                return None;
            }
            ("ahead", n)
        };
        // "the car behind our car's lane": of what is ours something else is meant
        let noun = tokens.get(i + n).is_some_and(|t| {
            t.kind == TokenKind::Word
                && matches!(t.text.as_str(), "lane" | "path" | "park" | "length" | "lengths")
        });
        let ego =
            words.ends_with("us") && matches!(tokens[i + n - 1].text.as_str(), "ego" | "car" | "vehicle");
        if noun || (ego && pointed_at(i)) {
            return None;
        }
        out.extend(words.split(' ').map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

/// Lengths without what blurs them; small numbers of things in words.
fn numbers(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        if let Some(n) = begins(&tokens[i..], ABOUT) {
            let length =
                tokens.get(i + n).is_some_and(|t| number(t).is_some()) && is_unit(tokens.get(i + n + 1));
            return length.then_some(i + n);
        }
        if let Some(n) = begins(&tokens[i..], GROUP_OF) {
            let many = tokens
                .get(i + n)
                .is_some_and(|t| number(t).is_some() && t.text != "a" && t.text != "an");
            return many.then_some(i + n);
        }
        // "two further cars": two more
        let more = begins(&tokens[i..], "further|additional|extra|supplementary").is_some()
            && i > 0
            && number(&tokens[i - 1]).is_some()
            && tokens[i - 1].text != "a"
            && !(i > 1 && matches!(tokens[i - 2].text.as_str(), "the" | "these" | "those" | "all"))
            && noun_at(&tokens[i + 1..]).is_some();
        if more {
            out.push(word("more", &tokens[i]));
            return Some(i + 1);
        }
        let TokenKind::Number(v) = tokens[i].kind else {
            return None;
        };
        let small = (2.0..=12.0).contains(&v) && v.fract() == 0.0;
        let plain = |t: Option<&Token>| {
            t.is_none_or(|t| matches!(t.kind, TokenKind::Word | TokenKind::Comma | TokenKind::Stop))
        };
        let before = i.checked_sub(1).map(|k| &tokens[k]);
        let named = before.is_some_and(|t| {
            matches!(
                t.text.as_str(),
                "at" | "model"
                    | "type"
                    | "no"
                    | "number"
                    | "lane"
                    | "box"
                    | "id"
                    | "x"
                    | "clip"
                    | "level"
                    | "version"
            )
        });
        let of_things = tokens.get(i + 1).is_some_and(|t| {
            t.kind == TokenKind::Word
                && (matches!(
                    t.text.as_str(),
                    "more" | "other" | "further" | "additional" | "extra" | "of" | "fewer" | "less"
                ) || noun_at(&tokens[i + 1..]).is_some()
                    || matches!(
                        longest(&tokens[i + 1..]),
                        Some((
                            Sense::State(..) | Sense::Color(_) | Sense::Size(_) | Sense::Attribute(_),
                            _
                        ))
                    ))
        });
        let counted = before
            .is_some_and(|t| matches!(t.text.as_str(), "the" | "other" | "these" | "those" | "all"))
            && !is_unit(tokens.get(i + 1));
        if !small || named || !plain(before) || !(of_things || counted) {
            return None;
        }
        // (between 2 and 12: it is an index)
        out.push(word(NUMBERS[v as usize - 2], &tokens[i]));
        Some(i + 1)
    })
}

/// What takes things away, before what is taken away.
const REMOVE: &str = "delete|erase|eliminate|get rid of|do away with|dispose of|dispense with|take away|take out|clear away|discard|scrap|ditch|banish|cancel|withdraw|\
    strip out|pull out|wipe out|throw out|kick out|chuck out|toss out|cut out|cut|lose|kill|bin|nix|purge|axe|dump|eradicate|exclude|drop out|edit out|rub out|\
    rule out|weed out|pluck out|yank out|rip out|oust|expel|evict|obliterate|annihilate|zap|trash|junk|unload|tow away|haul away|cart away|whisk away|wipe away|sweep away|yeet|nuke|strike out|scratch|ax|vaporize|vaporise|chop out|boot out|strike|zap away";
/// What brings a new thing.
const ADD: &str = "insert|introduce|spawn|throw in|stick in|drop in|put in|bring in|toss in|chuck in|slot in|include|generate|supply|conjure up|create|plonk|plop|pop in|inject|plonk down";
const MOVE: &str = "relocate|reposition|displace|transfer|shift|budge|dislocate|re position|re locate";
const TURN: &str =
    "rotate|spin|swivel|pivot|reorient|revolve|turn round|turn around|spin round|spin around|twist";
const CLEAR_ROAD: &str = "clear the highway|clear the motorway|clear the freeway|clear the street|clear the autobahn|clear the carriageway|empty the highway|empty the motorway|\
    empty the road|empty the street|clear this road|clear this street|clear the whole road|clear the whole street|clear the entire road";
const OF_THE_SCENE: &str = "worker|workers|road worker|construction worker|jogger|pedestrian|pedestrians|cones|barriers|excavator|digger|crane|cyclist|roller|bulldozer";
const SO_MANY: &str =
    "add|put|place|insert|draw|park|take|move|bring|remove|delete|send|line up|set up|paint|turn";
const WHEEL: &str = "wheel|swing";
const EXCHANGE: &str = "swap|switch|trade|exchange|supplant|supersede|swap out|switch out|change out|trade in|swap over|interchange";

/// A command in its commonest verb: "ditch the van", "spawn a bus", where a clause begins.
pub fn commands(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        // "nobody left on the sidewalk" tells no side
        let none = matches!(tokens[i].text.as_str(), "nobody" | "nothing" | "noone");
        if none
            && tokens.get(i + 1).is_some_and(|t| t.text == "left")
            && tokens
                .get(i + 2)
                .is_some_and(|t| matches!(t.text.as_str(), "on" | "in" | "at" | "there"))
        {
            out.push(tokens[i].clone());
            return Some(i + 2);
        }
        // "our worker" is in the scene; "our car" is the ego vehicle
        let there = || begins(tokens.get(i + 1..)?, OF_THE_SCENE);
        if tokens[i].text == "our" && !(i > 0 && tokens[i - 1].text == "of") && there().is_some() {
            out.push(word("the", &tokens[i]));
            return Some(i + 1);
        }
        // (a verb of motion, where it is none)
        if begins(&tokens[i..], "broken down").is_some() && tokens.get(i + 2..).and_then(noun_at).is_some() {
            out.push(word("stalled", &tokens[i]));
            return Some(i + 2);
        }
        if let Some(n) = begins(&tokens[i..], CLEAR_ROAD) {
            out.extend(["clear", "the", "road"].map(|w| word(w, &tokens[i])));
            let all = begins(
                &tokens[i + n..],
                "completely|entirely|of everything|totally|altogether",
            )
            .unwrap_or(0);
            return Some(i + n + all);
        }
        let starts = i == 0
            || matches!(tokens[i - 1].kind, TokenKind::Stop | TokenKind::Comma | TokenKind::Mark)
            || matches!(tokens[i - 1].text.as_str(), "and" | "then" | "please" | "kindly" | "just" | "so" | "now" | "also" | "but")
            // "can you ditch the van", "I want you to ditch it"
            || tokens[i - 1].text == "you" && i > 1 && matches!(tokens[i - 2].text.as_str(), "can" | "could" | "would" | "will" | "lets")
            || tokens[i - 1].text == "to" && i > 1 && matches!(tokens[i - 2].text.as_str(), "you" | "want" | "like" | "need" | "us" | "have");
        if !starts || tokens[i].kind != TokenKind::Word {
            return None;
        }
        let rest = &tokens[i..];
        let before =
            |n: usize, list: &[&str]| tokens.get(i + n).is_some_and(|t| list.contains(&t.text.as_str()));
        let counted = |n: usize| tokens.get(i + n).is_some_and(|t| number(t).is_some());
        let known = [
            "the",
            "all",
            "both",
            "every",
            "each",
            "that",
            "those",
            "these",
            "this",
            "it",
            "them",
            "him",
            "her",
            "one",
            "everything",
            "everyone",
            "everybody",
            "anything",
            "any",
            "whatever",
            "what",
            "whoever",
            "half",
            "my",
            "our",
        ];
        let new = ["a", "an", "another", "some", "one", "more"];
        let clause = || rest.iter().take_while(|t| t.kind != TokenKind::Stop);
        // "put exactly two cones there": so many come, whatever is there
        let verb_at = begins(rest, SO_MANY).filter(|n| before(*n, &["exactly", "just", "precisely"]));
        if let Some(n) = verb_at.filter(|n| counted(n + 1)) {
            out.extend_from_slice(&rest[..n]);
            return Some(i + n + 1);
        }
        // "cut the cones down to two" takes only some away
        let partly = || clause().any(|t| matches!(t.text.as_str(), "down" | "to" | "by" | "half" | "short"));
        let (verb, n) = if let Some(n) = begins(rest, REMOVE)
            .filter(|n| before(*n, &known) || counted(*n))
            .filter(|_| tokens[i].text != "cut" || !partly())
        {
            ("remove", n)
        } else if let Some(n) = begins(rest, ADD).filter(|n| before(*n, &new) || counted(*n)) {
            ("add", n)
        } else if let Some(n) = begins(
            rest,
            "keep one more|keep another|keep two more|keep also one|keep also a",
        ) {
            // (as Indian English has it)
            out.push(word("add", &tokens[i]));
            out.extend(tokens[i + 1..i + n].iter().filter(|t| t.text != "also").cloned());
            return Some(i + n);
        } else if let Some(n) = begins(rest, MOVE).filter(|n| before(*n, &known)) {
            ("move", n)
        } else if let Some(n) =
            begins(rest, TURN).filter(|n| before(*n, &known) && !clause().any(|t| t.text == "until"))
        {
            ("turn", n)
        } else if let Some(n) = begins(rest, WHEEL)
            .filter(|n| before(*n, &known) && clause().any(|t| matches!(t.text.as_str(), "around" | "round")))
        {
            ("turn", n)
        } else {
            // two known things change places; for something new one goes
            let n = begins(rest, EXCHANGE)?;
            let by = rest
                .iter()
                .position(|t| matches!(t.text.as_str(), "with" | "by" | "for" | "against"))?;
            let fresh = rest
                .get(by + 1)
                .is_some_and(|t| new.contains(&t.text.as_str()) || number(t).is_some());
            let plain =
                rest[..by].iter().all(|t| t.kind == TokenKind::Word) && begins(rest, "substitute").is_none();
            if !fresh || !plain || !(before(n, &known) || counted(n)) {
                return None;
            }
            out.push(word("replace", &tokens[i]));
            out.extend_from_slice(&tokens[i + n..i + by]);
            out.push(word("with", &tokens[i + by]));
            return Some(i + by + 1);
        };
        out.push(word(verb, &tokens[i]));
        Some(i + n)
    })
}
