//! Words to typed clauses: splits a text, and reads each part that is about the background.

use super::lexicon::{Word, lookup};
use super::tokens::{Token, TokenKind, tokens};
use super::{Amount, NearTo, SceneryClause, SceneryKind, SideOf, Verb, Where};
use place::beside_road::TextSpan;
use scene::background::PostKind;
use world::scenery::RoadsideKind;

/// The clauses of a text about the background, and the rest with the same bytes in the same places.
#[derive(Clone, Debug, Default)]
pub struct SceneryClauses {
    /// The clauses in order.
    pub said: Vec<SceneryClause>,
    /// The text with spaces in place of the parts that were taken.
    pub rest: String,
    /// Numbers in the parts that were taken that have no effect.
    pub idle: Vec<TextSpan>,
}

/// Reads all clauses about the background. `edits`: the text changes a scene rather than describes one.
pub fn take(text: &str, edits: bool) -> SceneryClauses {
    let tokens = tokens(text);
    let mut out = SceneryClauses {
        said: Vec::new(),
        rest: text.to_owned(),
        idle: Vec::new(),
    };
    let mut verb = None; // carried from one clause of a sentence to the next
    let mut before = true; // whether the clause before was taken
    for (joint, clause) in clauses(&tokens) {
        if joint.is_none_or(|t| t.kind == TokenKind::Stop || t.text == "then") {
            (verb, before) = (None, true);
        }
        let Some(span) = clause.first().zip(clause.last()).map(|(a, b)| a.span.to(b.span)) else {
            continue;
        };
        let said = read(clause, span, edits, verb).filter(|s| {
            // "a car behind a truck and a tree": part of the car's place.
            before || joint.is_some_and(|t| t.kind == TokenKind::Comma) || s.place != Where::default()
        });
        verb = said
            .as_ref()
            .map(|s| s.verb)
            .filter(|v| *v != Verb::Have)
            .or_else(|| {
                let first = clause.first().and_then(|t| lookup(&[t.text.as_str()]));
                match first {
                    Some((Word::Verb(v), _)) => Some(v),
                    _ => verb,
                }
            });
        before = said.is_some() || !clause.iter().any(|t| is_preposition(&t.text));
        let Some(said) = said else { continue };
        let joint = joint.filter(|t| t.kind == TokenKind::Word || t.kind == TokenKind::Comma);
        blank(&mut out.rest, joint.map_or(span, |t| t.span.to(span)));
        out.said.push(said);
        let idle = clause.iter().filter(|t| t.kind == TokenKind::Idle);
        out.idle.extend(idle.map(|t| t.span));
    }
    out
}

/// Puts spaces in place of a part of a text: the rest keeps its bytes.
pub fn blank(text: &mut String, span: TextSpan) {
    let spaces = " ".repeat(span.end - span.start);
    text.replace_range(span.start..span.end, &spaces);
}

fn is_preposition(word: &str) -> bool {
    const LIST: &[&str] = &[
        "behind", "front", "between", "near", "next", "beside", "by", "at", "past", "under", "with",
        "toward", "towards", "around", "against", "from", "into", "onto",
    ];
    LIST.contains(&word)
}

/// Clauses, each with the mark or word that joins it to the one before.
fn clauses(tokens: &[Token]) -> Vec<(Option<&Token>, &[Token])> {
    let joins = |i: usize| {
        let t = &tokens[i];
        let word = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
        match t.kind {
            TokenKind::Stop | TokenKind::Comma => true,
            TokenKind::Word => match t.text.as_str() {
                // "left and right" is one place
                "and" => !(word(i.wrapping_sub(1)) == "left" && word(i + 1) == "right"),
                "but" | "then" | "while" | "plus" => true,
                "with" => i > 0 && !matches!(word(i - 1), "lined" | "road" | "street"),
                _ => false,
            },
            _ => false,
        }
    };
    let (mut out, mut start, mut joint) = (Vec::new(), 0, None);
    for i in (0..tokens.len()).filter(|i| joins(*i)) {
        out.push((joint, &tokens[start..i]));
        // ", and" joins once.
        joint = match out.last() {
            Some((before, clause)) if clause.is_empty() && tokens[i].kind == TokenKind::Word => {
                before.or(Some(&tokens[i]))
            }
            _ => Some(&tokens[i]),
        };
        start = i + 1;
    }
    out.push((joint, &tokens[start..]));
    out.retain(|(_, clause)| !clause.is_empty());
    out
}

/// Reads one clause; `None` if it is not about the background, or not understood completely.
fn read(clause: &[Token], span: TextSpan, edits: bool, carried: Option<Verb>) -> Option<SceneryClause> {
    let words = senses(clause)?;
    let mut s = SceneryClause {
        span: Some(span),
        ..SceneryClause::new(Verb::Have, SceneryKind::Thing)
    };
    let (mut verb, mut what, mut article) = (None, None, None);
    let (mut no, mut all, mut comparative) = (false, false, None);
    let mut i = 0;
    while i < words.len() {
        let next = |k: usize| words.get(i + k).copied();
        match words[i] {
            Word::Verb(_) if verb.is_some() => return None,
            Word::Verb(v) => verb = Some(v),
            Word::What(..) if what.is_some() => {
                // "tree row", "a row of trees"; anything else is about two things.
                return None;
            }
            Word::What(w, plural) => {
                what = Some(w);
                s.plural = plural;
                s.definite = article == Some(Word::The);
                if let Some(Word::Number(n)) = next(1).filter(|_| clause.iter().any(|t| t.text == "#")) {
                    s.id = Some(n as u32);
                    i += 1;
                }
            }
            w @ (Word::A | Word::The) => article = Some(w),
            Word::No => no = true,
            Word::All => all = true,
            Word::Left if verb == Some(Verb::Move) && s.by.is_some() => s.way = Some((0.0, 1.0)),
            Word::Right if verb == Some(Verb::Move) && s.by.is_some() => s.way = Some((0.0, -1.0)),
            Word::Ahead if verb == Some(Verb::Move) && s.by.is_some() => s.way = Some((1.0, 0.0)),
            Word::Behind if verb == Some(Verb::Move) && s.by.is_some() => s.way = Some((-1.0, 0.0)),
            Word::Left | Word::Right if s.place.side.is_some() => return None,
            Word::Left => s.place.side = Some(SideOf::Left),
            Word::Right => s.place.side = Some(SideOf::Right),
            Word::Both => {}
            Word::Ahead => s.place.ahead = Some(true),
            // "behind the trees" is not the place of a thing
            Word::Behind if i + 1 < words.len() && what.is_some() && verb.is_none() => return None,
            Word::Behind => s.place.ahead = Some(false),
            Word::Near => s.place.near = s.place.near.or(Some(NearTo::Ego)),
            Word::Crossing => s.place.near = Some(NearTo::Crossing),
            Word::Junction => s.place.near = Some(NearTo::Junction),
            Word::Me => s.place.near = s.place.near.or(Some(NearTo::Ego)),
            Word::Road => {
                // "near the road" holds for all scenery
                if s.place.near == Some(NearTo::Ego) {
                    s.place.near = None;
                }
            }
            Word::Along => s.place.along = true,
            Word::Number(n) => i += number(&mut s, n, (words.as_slice(), i), verb, carried)?,
            Word::Tall if what.is_some() && verb == Some(Verb::Make) => comparative = Some(Verb::Raise),
            Word::Tall => s.tall = Some(true),
            Word::Low => s.tall = Some(false),
            Word::Taller => comparative = Some(Verb::Raise),
            Word::Lower => comparative = Some(Verb::Lower),
            Word::Dense => s.dense = Some(true),
            Word::Sparse => s.dense = Some(false),
            Word::Nearest => s.nearest = Some(true),
            Word::Furthest => s.nearest = Some(false),
            Word::Row => s.row = true,
            Word::Storey | Word::Metre => return None,
            Word::To | Word::By | Word::Filler => {}
        }
        i += 1;
    }
    s.what = what?;
    if s.what == SceneryKind::Thing && s.id.is_none() {
        return None;
    }
    s.place.along |= s.row;
    s.plural |= no || all;
    s.verb = match (verb.or(carried.filter(|_| edits)), comparative) {
        _ if no && verb.is_none_or(|v| v == Verb::Make || v == Verb::Have) => Verb::Remove,
        // "no" beside another command cannot be carried out
        _ if no => return None,
        (Some(Verb::Make) | None, Some(change)) => change,
        (Some(Verb::Add), Some(_)) | (Some(Verb::Remove), _) if s.by.is_some() => return None,
        (Some(Verb::Make), None) => {
            s.height?;
            Verb::Raise
        }
        (Some(v), _) => v,
        (None, None) => Verb::Have,
    };
    if s.verb == Verb::Move && (s.by.is_none() || s.way.is_none()) {
        return None;
    }
    match s.verb {
        // A description states that things are there, not which: "the building" alone belongs to another sentence.
        Verb::Have if edits && s.height.is_some() && s.definite => s.verb = Verb::Raise,
        Verb::Have if s.definite => return None,
        Verb::Have if edits => s.verb = Verb::Add,
        _ => {}
    }
    // "Clear the car park" is about the objects on it, "bus stops ahead" about a bus.
    let cleared =
        matches!(s.what, SceneryKind::Place(p) if p != RoadsideKind::Forest) && s.verb == Verb::Remove && !no;
    let stops = s.what == SceneryKind::Post(PostKind::BusStop) && verb.is_none();
    if cleared || stops {
        return None;
    }
    // Surroundings as a whole ("a forest") belong to the other reader unless a side is named.
    let whole = matches!(s.what, SceneryKind::Place(_)) && s.place.side.is_none() && verb.is_none() && !no;
    let other = whole && !words.contains(&Word::Both);
    (!other && (edits || !may_be_barrier(&s))).then_some(s)
}

/// Reads a number and its unit or thing: the number of words after it that belong to it. `None` if it fits nothing.
fn number(
    s: &mut SceneryClause,
    n: f64,
    (words, i): (&[Word], usize),
    verb: Option<Verb>,
    carried: Option<Verb>,
) -> Option<usize> {
    let next = |k: usize| words.get(i + k).copied();
    if !n.is_finite() || n < 0.0 {
        return None;
    }
    let before = i.checked_sub(1).map(|k| words[k]);
    let wants = |v: Verb| verb == Some(v) || (verb.is_none() && carried == Some(v));
    let taken = match (next(1), next(2)) {
        (Some(Word::Storey), after) => {
            let grows = matches!(after, Some(Word::Taller | Word::Lower));
            let changes = before == Some(Word::By) || wants(Verb::Raise) || wants(Verb::Lower);
            match grows || (changes && before != Some(Word::To)) {
                true => s.by = Some(Amount::Storeys(n)),
                false => s.height = Some(Amount::Storeys(n)),
            }
            1
        }
        (Some(Word::Metre), Some(Word::Tall | Word::Low)) => {
            s.height = Some(Amount::Metres(n));
            2
        }
        (Some(Word::Metre), Some(Word::Taller | Word::Lower)) => {
            s.by = Some(Amount::Metres(n));
            1
        }
        (Some(Word::Metre), _) => {
            match () {
                () if before == Some(Word::To) => s.height = Some(Amount::Metres(n)),
                () if before == Some(Word::By) || wants(Verb::Move) => s.by = Some(Amount::Metres(n)),
                () if wants(Verb::Raise) || wants(Verb::Lower) => s.by = Some(Amount::Metres(n)),
                () => s.place.distance_m = Some(n),
            }
            1
        }
        (Some(Word::What(..) | Word::Tall | Word::Low | Word::Row), _) => {
            s.count = Some(n.min(500.0) as u32);
            0
        }
        _ => return None,
    };
    Some(taken)
}

/// True if the word may also name barriers, which are boxes, and nothing indicates that it runs along the road.
pub fn may_be_barrier(s: &SceneryClause) -> bool {
    use scene::background::LineKind::{Fence, GuardRail};
    matches!(s.what, SceneryKind::Line(Fence | GuardRail)) && !s.place.along
}

/// Meanings of the words of a clause, one after another; `None` if one is not known.
fn senses(clause: &[Token]) -> Option<Vec<Word>> {
    let is_word = |t: &&Token| t.text != "#" && t.kind != TokenKind::Idle;
    let clause: Vec<&Token> = clause.iter().filter(is_word).collect();
    let words: Vec<&str> = clause.iter().map(|t| t.text.as_str()).collect();
    let mut out = Vec::new();
    let mut i = 0;
    while i < words.len() {
        if let TokenKind::Number(n) = clause[i].kind {
            out.push(Word::Number(n));
            i += 1;
            continue;
        }
        let (word, n) = lookup(&words[i..])?;
        out.push(word);
        i += n;
    }
    Some(out)
}
