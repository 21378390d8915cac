//! Verbs with their forms by rule: `base/past/participle` where they are irregular, several words inflect in the first.
//! From one line come "creep", "creeps", "creeping", "crept", "has crept".

use crate::scene::graph::ObjectState;
use crate::scene::graph::RelationKind as R;

/// The forms of one verb.
pub struct Forms {
    /// "seal off".
    pub base: String,
    /// "seals off".
    pub s: String,
    /// "sealing off".
    pub ing: String,
    /// "sealed off", as in "it sealed off the lane".
    pub past: String,
    /// "sealed off", as in "has been sealed off".
    pub participle: String,
}

fn ends_in_consonant(word: &str) -> bool {
    // "stop" doubles, "creep", "wait" and "queue" do not
    let c: Vec<char> = word.chars().rev().take(3).collect();
    let vowel = |c: char| matches!(c, 'a' | 'e' | 'i' | 'o' | 'u');
    matches!(c.as_slice(), [z, y, x] if !vowel(*z) && !matches!(z, 'w' | 'x' | 'y') && vowel(*y) && !vowel(*x))
        && word.chars().filter(|c| vowel(*c)).count() == 1
}

fn with_s(word: &str) -> String {
    if ["s", "x", "z", "ch", "sh", "go", "do"]
        .iter()
        .any(|t| word.ends_with(t))
    {
        return format!("{word}es");
    }
    match word.strip_suffix('y') {
        Some(stem) if !stem.ends_with(['a', 'e', 'i', 'o', 'u']) => format!("{stem}ies"),
        _ => format!("{word}s"),
    }
}

fn with_ing(word: &str) -> String {
    if let Some(stem) = word.strip_suffix("ie") {
        return format!("{stem}ying");
    }
    match word.strip_suffix('e') {
        Some(stem) if !stem.ends_with(['e', 'o', 'y']) => format!("{stem}ing"),
        _ if ends_in_consonant(word) => format!("{word}{}ing", word.chars().last().unwrap_or(' ')),
        _ => format!("{word}ing"),
    }
}

fn with_ed(word: &str) -> String {
    if word.ends_with('e') {
        return format!("{word}d");
    }
    match word.strip_suffix('y') {
        Some(stem) if !stem.ends_with(['a', 'e', 'i', 'o', 'u']) => format!("{stem}ied"),
        _ if ends_in_consonant(word) => format!("{word}{}ed", word.chars().last().unwrap_or(' ')),
        _ => format!("{word}ed"),
    }
}

/// All forms of an entry.
pub fn forms(entry: &str) -> Forms {
    let mut parts = entry.split('/').map(str::trim);
    let base = parts.next().unwrap_or(entry);
    let (word, tail) = base.split_once(' ').map_or((base, ""), |(w, t)| (w, t));
    let join = |w: String| if tail.is_empty() { w } else { format!("{w} {tail}") };
    // An irregular form may stand alone or with its tail.
    let bare = |f: &str| f.strip_suffix(tail).map_or(f, str::trim_end).to_string();
    let past = parts.next().map_or_else(|| with_ed(word), bare);
    let participle = parts.next().map_or_else(|| past.clone(), bare);
    Forms {
        base: base.to_string(),
        s: join(with_s(word)),
        ing: join(with_ing(word)),
        past: join(past),
        participle: join(participle),
    }
}

/// What something does that only says whether it moves.
pub const DOING: &[(ObjectState, &str)] = &[
    (
        ObjectState::Moving,
        "move|drive/drove/driven|ride/rode/ridden|roll|travel|cruise|coast|glide|drift|trundle|rumble|thunder|roar|hurtle|barrel|speed/sped|race|zoom|whizz|whiz|zip|dart|dash|\
         hurry|rush|run/ran/run|sprint|jog|walk|stroll|amble|saunter|stride/strode|march|plod|trudge|shuffle|wander|meander|roam|hike|limp|hobble|waddle|toddle|tiptoe|pace|\
         wheel|pedal|cycle|bike|scoot|skate|motor|chug|putter|potter|dawdle|crawl|creep/crept|inch|edge|nose|squeeze|proceed|advance|progress|head|steer|sail|fly/flew/flown|bounce|\
         weave/wove/woven|swerve|veer|swing/swung|zigzag|wobble|accelerate|brake|slow down|slow|reverse|back up|back out|overtake/overtook/overtaken|undertake|pass|go/went/gone|come/came/come|come up|\
         go by|turn|turn left|turn right|turn off|turn in|merge|filter|pull out|pull away|pull over|pull in|pull off|set off|drive off|drive away|ride off|ride away|walk off|walk away|\
         roll past|speed past/sped past|\
         approach|near|arrive|enter|leave/left|exit|emerge|appear|close in|catch up|cut in|barge in|circulate|circle|trot|bolt|scurry|scamper|rattle|clatter|lumber|slide/slid|skid|flow|stream|parade|commute|canter|step|step out|play|frolic|skip|hop|jump|stagger|lurch|wind/wound|snake|thread|make its way/made|make his way/made|make her way/made|make their way/made",
    ),
    (
        ObjectState::Waiting,
        "wait|hide/hid/hidden|crouch|cower|squat|shelter|take cover/took cover|stand/stood|stand still/stood|stand there/stood|stop|stop dead|halt|pause|idle|tarry|queue|queue up|line up|sit/sat|sit there/sat|rest|linger|loiter|loaf|lurk|lounge|dally|hover|hang about/hung|hang around/hung|stand around/stood|sit around/sat|wait around|lounge around|loiter around|hang out/hung|lean|squat|crouch|kneel|perch|lie/lay/lain|stay|remain|stay put|hold/held|\
         chat|talk|gossip|smoke|gaze|stare|chatter|converse|confer|argue|laugh|wave|gather|assemble|congregate|huddle|cluster|mill about|stall|yield|give way/gave/given|pull up|draw up/drew/drawn|come to a stop/came/come|come to a halt/came/come|come to a standstill/came/come|come to a complete stop/came/come|come to a complete standstill/came/come|come to rest/came/come|grind to a halt/ground|bide|dither|hesitate|tower|repose|work|dig/dug|repair|inspect|photograph|read/read/read|\
         be lined up/was|be stuck/was|get stuck/got|be stopped/was|pile up|bunch up|back up",
    ),
    (ObjectState::Parked, "break down/broke/broken|double park"),
];

/// What something does to what follows; the passive turns it around.
pub const RELATING: &[(R, &str)] = &[
    (
        R::Blocking,
        "block|block off|block up|obstruct|close|close off|shut|shut off|seal|seal off|cordon off|fence off|cone off|rope off|tape off|wall off|cut off/cut off|barricade|blockade|impede|hinder|hamper|encumber|\
         clog|clog up|plug|choke|jam|jam up|stop up|straddle|occupy|take up/took up/taken up|fill|fill up|cover|hog|monopolise|monopolize|command|commandeer|narrow|restrict|hold up/held up/held up|obstruct access to|stand in the way of/stood in the way of/stood in the way of|get in the way of/got in the way of/got in the way of|stretch across|sprawl across|park across|lie across/lay across/lain across|stop across|stand across/stood across/stood across|sit across/sat across/sat across|halt in|strand in|span|guard",
    ),
    (
        R::Following,
        "follow|tail|tailgate|trail|shadow|pursue|chase|track|stalk|trail behind|trail after|tag along behind|drive behind/drove behind/driven behind|ride behind/rode behind/ridden behind|run behind/ran behind/run behind|roll behind|travel behind|cycle behind|queue behind|queue up behind|line up behind|drive after/drove after/driven after|chase after|run after/ran after/run after|keep behind/kept behind/kept behind|stick behind/stuck behind/stuck behind|crawl behind|creep behind/crept behind|come after/came after/come after|come behind/came behind/come behind|come up behind/came up behind/come up behind|catch up with/caught up with/caught up with|close in on|close up on|close up behind|pedal behind|stick to/stuck to/stuck to|hang behind/hung behind/hung behind|ride after/rode after/ridden after|bring up the rear behind/brought up the rear behind/brought up the rear behind",
    ),
    (
        R::InFrontOf,
        "lead/led/led|precede|head up|pull in in front of|cut in in front of|cut up|drive ahead of/drove ahead of/driven ahead of|ride ahead of/rode ahead of/ridden ahead of|run ahead of/ran ahead of/run ahead of|walk ahead of",
    ),
    (
        R::Crossing,
        "cross|traverse|cut across/cut across/cut across|step across|walk across|run across/ran across/run across|dash across|dart across|hurry across|rush across|race across|sprint across|jog across|stroll across|amble across|saunter across|wander across|shuffle across|hobble across|limp across|march across|\
         stride across/strode across/stridden across|trot across|scurry across|scamper across|tiptoe across|skip across|hop across|plod across|trudge across|make its way across/made its way across|make his way across/made his way across|make her way across/made her way across|make their way across/made their way across|\
         go across/went across/gone across|get across/got across/got across|come across/came across/come across|move across|pass over|pass across|walk over|run over/ran over/run over|go over/went over/gone over|step over|hurry over|stroll over|wander over|step onto|step into|step out onto|step out into|step off|run onto/ran onto/run onto|run into/ran into/run into|run out into/ran out into/run out into|run out onto/ran out onto/run out onto|walk onto|walk into|walk out into|walk out onto|dash onto|dash into|dash out into|dart onto|dart into|dart out into|wander onto|wander into|stray onto|stray into|stumble onto|stumble into|set foot on|jaywalk across|negotiate",
    ),
    (
        R::Facing,
        "face|confront|eye|watch|look at|look towards|gaze at|stare at|point at|point to|point straight at|point right at|point towards|aim at|head for|head towards|head toward|make for/made for/made for|bear down on/bore down on|close in on|approach|near",
    ),
    (
        R::FacingAway,
        "walk away from|drive away from/drove away from/driven away from|run away from/ran away from/run away from|ride away from/rode away from/ridden away from|move away from|go away from/went away from/gone away from|head away from|roll away from|cycle away from|jog away from|turn away from|look away from|face away from|hurry away from|stroll away from|point away from",
    ),
    (
        R::NextTo,
        "join|flank|adjoin|border|accompany|escort|abut|hug|skirt|pull alongside|pull up next to|pull up beside|draw level with/drew level with/drawn level with|draw alongside/drew alongside/drawn alongside|keep pace with/kept pace with|push|wheel",
    ),
    (
        R::Near,
        "surround|ring|encircle|enclose|fence in|hem in/hemmed in/hemmed in|protect|shield|secure|screen|mark|mark off|delimit|crowd around|crowd round|gather around|gather round|huddle around|cluster around|mill around|stand around/stood around|attend|attend to|tend to|work on|inspect|repair|look after|examine|talk to|chat with|speak to/spoke to/spoken to",
    ),
];

/// Something drawn by what comes before: "a tractor tows a trailer", and "a trailer towed by a tractor".
pub const TOWING: &str = "tow|pull|haul|drag|tug|draw/drew/drawn|lug|trail along|pull along|tow away";

/// What witnesses and reports do: they are not in the scene.
pub const SAYING: &str = "say/said|state|report|claim|count|observe|see/saw/seen|notice|recall|remember|describe|mention|testify|note|speak of/spoke of/spoken of|tell/told|tell of/told of|complain|complain about|complain of|grumble|grumble about|moan about|talk of|talk about|record|confirm|declare|insist|explain|write/wrote/written|list|show/showed/shown|spot|reckon|believe|think/thought|guess|swear/swore/sworn|indicate|suggest|announce|counted on|have seen/had seen";

/// The sky's verbs: weather as in [`super::style::WEATHERS`].
pub const SKY: &[(super::super::description::Weather, &str)] = &[
    (
        super::super::description::Weather::Rain,
        "rain|pour|pour down|pour with rain|bucket|bucket down|drizzle|pelt down|lash down|teem down|tip down|chuck down|hammer down|belt down|sheet down|spit with rain|rain down|hail|thunder and lightning|piss down",
    ),
    (
        super::super::description::Weather::Snow,
        "snow|snow down|snow heavily|sleet",
    ),
];

/// Joined to the back of what follows.
pub const JOINED: &str = "hitched to|attached to|coupled to|hooked up to|hooked to|hooked onto|hitched up to|hitched onto|tied to|fastened to|connected to|in tow of|hanging off|on the hook of|hitched behind|coupled behind|attached behind|hooked behind";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_follow_rules() {
        let all = |e: &str| {
            let f = forms(e);
            [f.base, f.s, f.ing, f.past, f.participle].join(" ")
        };
        assert_eq!(all("creep/crept"), "creep creeps creeping crept crept");
        assert_eq!(all("stop"), "stop stops stopping stopped stopped");
        assert_eq!(all("hurry"), "hurry hurries hurrying hurried hurried");
        assert_eq!(
            all("seal off"),
            "seal off seals off sealing off sealed off sealed off"
        );
        assert_eq!(all("queue"), "queue queues queuing queued queued");
        assert_eq!(all("lie/lay/lain"), "lie lies lying lay lain");
        assert_eq!(all("pass"), "pass passes passing passed passed");
        assert_eq!(all("trundle"), "trundle trundles trundling trundled trundled");
    }
}
