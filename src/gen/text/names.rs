//! Names and paints of boxes in words: what a prompt calls its objects, and whom an edit means by "the red taxi".

use std::collections::HashMap;
use std::sync::LazyLock;

use super::description::ObjectSpec;
use super::lexicon::plural;
use super::mention::Mention;
use super::words::edits::Pick;
use super::words::objects::NOUNS;
use crate::scene::{BoxLabel, BoxName, Paint, SceneBox};

/// Nouns that say no more than the class: they name no box, and mean every box of it.
const GENERIC: &str = "car|auto|automobile|motorcar|motor car|passenger car|vehicle|motor vehicle|private car|traffic|\
    truck|lorry|hgv|heavy goods vehicle|heavy truck|heavy lorry|goods vehicle|bus|coach|trailer|construction vehicle|\
    construction machine|machine|site vehicle|pedestrian|person|human|human being|individual|someone|somebody|figure|\
    passer by|passerby|walker|people|folk|folks|bystander|bicycle|bike|cycle|pushbike|push bike|cyclist|bicyclist|rider|\
    biker|motorcycle|motorbike|motorcyclist|traffic cone|cone|pylon|road cone|barrier|road barrier|fence|object|box|\
    thing|one|other|crowd|group|family|crowd of people|crew|work crew|working crew|road crew|construction crew|building crew|\
    repair crew|maintenance crew|road gang|work gang|working party|work party|work team|construction team";

/// Names of one thing: whoever is called by one of a line is meant by the others.
const SAME: &[&str] = &[
    "taxi|taxicab|cab|taxi cab|minicab|uber|robotaxi|black cab|hackney cab|hackney carriage|cabs|minivan taxi|van taxi",
    "police car|patrol car|police cruiser|cop car|squad car|police vehicle|cop cruiser|police interceptor|panda car|\
     sheriff car|sheriffs car|prowl car|patrol vehicle|highway patrol car",
    "ambulance|ambulence|ambulance car|emergency ambulance|rescue van|paramedic van|medical van|ambulance van",
    "van|panel van|transit|transit van|transporter|transporter van|delivery van|cargo van|courier van|\
     parcel van|parcel delivery van|sprinter|postal van|mail van|work van|commercial van",
    "minivan|people carrier|mpv|mini van|people mover|mini mpv",
    "camper|campervan|camper van|camping van|motorhome|motor home|rv|recreational vehicle|winnebago",
    "suv|jeep|off roader|offroader|four by four|4wd|crossover|four wheel drive|sport utility vehicle|\
     sports utility vehicle|s u v|compact suv|off road vehicle",
    "sports car|sportscar|supercar|porsche|ferrari|lamborghini|racing car|race car|roadster",
    "limousine|limo|stretch limo|stretch limousine",
    "sedan|saloon|saloon car|family saloon",
    "station wagon|estate|estate car|wagon|estate wagon",
    "convertible|cabriolet|cabrio|soft top|cabriolet car",
    "pickup|pick up|pickup truck|pick up truck|ute|bakkie",
    "fire engine|fire truck|firetruck|fire appliance|fire brigade truck|fire lorry|fire tender|fire brigade vehicle|\
     fire brigade engine|fire rescue truck|ladder truck",
    "tanker|tanker truck|fuel truck|petrol tanker|oil tanker|fuel tanker|tank truck|gas tanker|milk tanker|tanker lorry|\
     gasoline tanker|water tanker|chemical tanker",
    "garbage truck|refuse truck|trash truck|bin lorry|dustcart|rubbish truck|recycling truck|garbage lorry|bin truck|\
     waste lorry|refuse lorry|dust cart|waste truck|bin wagon|refuse wagon|garbage collector truck",
    "tow truck|breakdown truck|recovery truck|wrecker|breakdown lorry|recovery lorry|recovery vehicle|tow lorry",
    "dump truck|dumper truck|dumper|tipper|tipper truck|tipper lorry|tip truck|tipping lorry",
    "delivery truck|delivery lorry|box truck|parcel truck|ups truck|dhl truck|fedex truck|box lorry",
    "removal van|removals van|removal lorry|moving truck|removal truck|furniture lorry|furniture truck|moving lorry",
    "concrete mixer|cement mixer|cement truck|concrete truck|mixer truck|concrete lorry|cement lorry|readymix",
    "street sweeper|road sweeper|sweeper|sweeper truck|street cleaning vehicle",
    "snow plough|snowplough|snowplow|snow plow|gritter|plough",
    "semi|semi truck|artic|articulated lorry|eighteen wheeler|18 wheeler|big rig|juggernaut|tractor trailer|road train",
    "school bus|schoolbus|school coach",
    "double decker|double decker bus|double deck bus|decker bus|routemaster|two decker|decker",
    "minibus|mini bus|microbus|midibus",
    "city bus|citybus|public bus|town bus|transit bus|local bus",
    "tour bus|tourist bus|tour coach|sightseeing bus|tourist coach|touring coach",
    "tram|streetcar|tramcar|tram car|trolley|trolley car|light rail",
    "caravan|travel trailer|camping caravan|touring caravan|camper trailer|mobile home",
    "excavator|digger|mechanical digger|bagger|backhoe|mini digger|mini excavator|minidigger|power shovel",
    "bulldozer|dozer|bull dozer",
    "road roller|steamroller|steam roller|roller|compactor|asphalt roller",
    "forklift|fork lift|forklift truck|fork truck|fork lift truck",
    "crane|mobile crane|crane truck|truck crane",
    "scooter|moped|motor scooter|vespa|moped rider|scooter rider",
    "worker|construction worker|road worker|workman|builder|labourer|laborer|roadworker",
    "police officer|policeman|policewoman|cop|officer|constable|patrolman|traffic officer",
    "child|kid|boy|girl|schoolchild|toddler|little boy|little girl|pupil|schoolboy|schoolgirl|school child|schoolkid|\
     small child|young child|youngster|little child|little kid|infant|small boy|small girl",
    "jogger|runner",
    "man|guy|bloke|gentleman|chap|fella|lad|male|dude|gent",
    "woman|lady|female|gal",
    "old man|old woman|old lady|elderly person|senior|pensioner|elderly man|elderly woman|senior citizen|granny|\
     grandma|grandpa|grandad|granddad|grandmother|grandfather|oap",
    "bollard|post|steel bollard|concrete bollard",
];

/// Nouns for kinds that have several names: what they may be called.
const KINDS: &[(&str, &[&str])] = &[(
    "emergency vehicle|emergency service|emergency services|rescue vehicle",
    &["police car", "ambulance", "fire engine"],
)];

/// Plural (and every singular) to singular.
static SINGULAR: LazyLock<HashMap<String, &'static str>> = LazyLock::new(|| {
    let mut table = HashMap::new();
    for noun in NOUNS {
        for word in noun.words.split('|') {
            let mut forms = word.trim().split('/');
            let Some(one) = forms.next() else { continue };
            table.entry(one.to_owned()).or_insert(one);
            for many in forms {
                table.entry(many.to_owned()).or_insert(one);
            }
            table.entry(plural(one)).or_insert(one);
        }
    }
    table
});

/// A noun in the singular.
pub fn singular(noun: &str) -> &str {
    SINGULAR.get(noun).copied().unwrap_or(noun)
}

fn is_generic(noun: &str) -> bool {
    // ("other vehicles" are any that were not spoken of)
    let noun = noun.strip_prefix("other ").unwrap_or(noun);
    noun.is_empty() || GENERIC.split('|').any(|w| w == noun)
}

/// The paint that colour words name; `None` where they name none that boxes have.
pub fn paint_of(words: &str) -> Option<Paint> {
    const BY_WORD: &[(Paint, &str)] = &[
        (
            Paint::Red,
            "red|scarlet|ruby|vermilion|crimson|burgundy|maroon|cherry|coral|rust",
        ),
        (Paint::Silver, "silver|silvery|chrome|metallic"),
        (Paint::Grey, "grey|gray|charcoal|anthracite|gunmetal|graphite"),
        (Paint::Black, "black|ebony"),
        (Paint::White, "white|ivory|pearl"),
        (Paint::Orange, "orange|amber|copper"),
        (Paint::Yellow, "yellow|golden|gold|mustard|neon"),
        (
            Paint::Green,
            "green|emerald|olive|khaki|mint|lime|camouflage|camo",
        ),
        (
            Paint::Blue,
            "blue|navy|turquoise|teal|cyan|aqua|aquamarine|indigo",
        ),
        (Paint::Purple, "purple|violet|lilac|lavender|mauve|plum"),
        (Paint::Pink, "pink|magenta|fuchsia|rose|salmon"),
        (Paint::Brown, "brown|chocolate|hazel|bronze|ochre"),
        (Paint::Beige, "beige|cream|tan|champagne|sand"),
    ];
    let words = words.to_lowercase();
    // ("off white", "navy blue", "rust coloured": the last word that names one, of two paints the last)
    words.split([' ', '-']).rev().find_map(|word| {
        let named = BY_WORD
            .iter()
            .find(|(_, list)| list.split('|').any(|w| w == word));
        named.map(|(paint, _)| *paint)
    })
}

/// What boxes of a description are called.
pub fn label_of(spec: &ObjectSpec) -> BoxLabel {
    let noun = singular(&spec.noun);
    let name = if is_generic(noun) || spec.noun != spec.noun.to_lowercase() {
        BoxName::default()
    } else {
        BoxName::new(noun)
    };
    BoxLabel {
        name,
        paint: spec
            .color
            .as_deref()
            .filter(|c| !c.starts_with("not "))
            .and_then(paint_of),
    }
}

/// True if these nouns name things of two kinds: an excavator is no bulldozer.
pub fn are_of_two_kinds(one: &str, other: &str) -> bool {
    let kind = |noun: &str| {
        let noun = singular(noun);
        SAME.iter().position(|g| g.split('|').any(|w| w.trim() == noun))
    };
    matches!((kind(one), kind(other)), (Some(a), Some(b)) if a != b)
        && !is_called(singular(one), singular(other))
}

/// True if a box of this name may be called by that noun.
pub fn is_called(name: &str, noun: &str) -> bool {
    let part = |whole: &str, part: &str| {
        whole
            .strip_suffix(part)
            .is_some_and(|rest| rest.is_empty() || rest.ends_with(' '))
    };
    let name = name.to_lowercase();
    let group = |words: &str| {
        SAME.iter()
            .filter(|g| g.split('|').any(|w| w.trim() == words))
            .collect::<Vec<_>>()
    };
    let (of_name, of_noun) = (group(&name), group(noun));
    let kind = KINDS.iter().find(|k| k.0.split('|').any(|w| w == noun));
    if let Some((_, names)) = kind {
        return names.iter().any(|n| is_called(&name, n));
    }
    part(&name, noun) || part(noun, &name) || of_name.iter().any(|g| of_noun.contains(g))
}

/// True if a box may be what is named: it is of its classes, and called nothing else.
pub fn may_be(b: &SceneBox, m: &Mention) -> bool {
    let noun = singular(&m.spec.noun);
    m.classes.contains(&b.class)
        && (is_generic(noun) || b.label.name.is_empty() || is_called(b.label.name.as_str(), noun))
}

/// Of the boxes of its classes those that a mention names by paint and name. Without any so called, those that are
/// called nothing at all; without these, all: other words for the same thing are many.
pub fn called<'b>(fit: Vec<&'b SceneBox>, m: &Mention) -> Vec<&'b SceneBox> {
    let mut fit = fit;
    let said = m.spec.color.as_deref();
    let denied = said.and_then(|c| c.strip_prefix("not ")).and_then(paint_of);
    if let Some(paint) = denied {
        fit.retain(|b| b.label.paint != Some(paint));
    } else if let Some(paint) = said.and_then(paint_of) {
        let painted: Vec<&SceneBox> = fit
            .iter()
            .copied()
            .filter(|b| b.label.paint == Some(paint))
            .collect();
        if painted.is_empty() {
            fit.retain(|b| b.label.paint.is_none());
            // Of one that is not known to be red the word may be true; of several it tells nothing.
            if fit.len() > 1 && m.plural {
                fit.clear();
            }
        } else {
            fit = painted;
        }
    }
    let noun = singular(&m.spec.noun);
    // ("everything" is whatever its parts are called)
    if is_generic(noun) || super::mention::means_all(m) {
        return fit;
    }
    let pick = |keep: &dyn Fn(&SceneBox) -> bool| -> Vec<&'b SceneBox> {
        fit.iter().copied().filter(|b| keep(b)).collect()
    };
    let so_called = pick(&|b| !b.label.name.is_empty() && is_called(b.label.name.as_str(), noun));
    let by_this_word = pick(&|b| b.label.name.as_str().eq_ignore_ascii_case(noun));
    match (m.plural, by_this_word.is_empty(), so_called.is_empty()) {
        (false, false, _) => return by_this_word,
        (_, _, false) => return so_called,
        _ => {}
    }
    let nameless = pick(&|b| b.label.name.is_empty());
    if nameless.is_empty() { fit } else { nameless }
}

/// "The car", where a taxi is there, too: so many as are meant that are called nothing else. All, if that does not tell.
pub fn plainly(fit: Vec<SceneBox>, m: &Mention) -> Vec<SceneBox> {
    let n = m.spec.count.n as usize;
    let all = m.plural && m.uncounted || m.pick.is_some_and(|p| p != Pick::More);
    // ("the vehicle" may be a van as well as a car)
    let any = m.classes.len() > 1 && m.spec.class != crate::scene::Class::Pedestrian;
    if all || any || fit.len() <= n || !is_generic(singular(&m.spec.noun)) {
        return fit;
    }
    let plain: Vec<SceneBox> = fit.iter().copied().filter(|b| b.label.name.is_empty()).collect();
    let bare: Vec<SceneBox> = plain
        .iter()
        .copied()
        .filter(|b| b.label.paint.is_none())
        .collect();
    match (plain.len() == n, bare.len() == n && m.spec.color.is_none()) {
        (true, _) => plain,
        (_, true) => bare,
        _ => fit,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_paints() {
        for (words, paint) in [
            ("navy blue", Some(Paint::Blue)),
            ("dark red", Some(Paint::Red)),
            ("rust coloured", Some(Paint::Red)),
            ("off white", Some(Paint::White)),
            ("two tone", None),
            ("dark", None),
        ] {
            assert_eq!(paint_of(words), paint, "{words}");
        }
    }

    #[test]
    fn names_mean_what_they_are_called() {
        assert!(is_called("taxi", "cab"));
        assert!(is_called("school bus", "bus"));
        assert!(is_called("fire engine", "fire truck"));
        assert!(is_called("van", "delivery van"));
        assert!(is_called("police car", "emergency vehicle"));
        assert!(!is_called("taxi", "emergency vehicle"));
        assert!(!is_called("taxi", "van"));
        assert!(!is_called("minivan", "van"));
        assert_eq!(singular("taxis"), "taxi");
        assert_eq!(singular("children"), "child");
    }
}
