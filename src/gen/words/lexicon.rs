//! Meanings of words, from `assets/words/lexicon.txt`: phrases of up to five words to senses. Twin of
//! `training/words/lexicon.py`.

use std::collections::{BTreeSet, HashMap};
use std::sync::LazyLock;

/// Most words of a phrase.
pub const LONGEST_PHRASE: usize = 5;

/// One meaning of a phrase.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Sense {
    /// `noun`, `group`, `paint`, `time`, `weather`, `env`, `density`, `road`, `place`, `ego`.
    pub kind: &'static str,
    /// Symbol of the sense: `police_car`, `night`.
    pub symbol: &'static str,
    /// True for a plural.
    pub many: bool,
}

/// A unit of length or of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Factor to metres, or to km/h.
    pub times: f64,
    /// True for a unit of speed.
    pub is_speed: bool,
}

/// All phrases.
pub struct Lexicon {
    senses: HashMap<String, Vec<Sense>>,
    units: HashMap<String, Unit>,
    ids: HashMap<Sense, usize>,
    /// Single words that name a kind of thing, with its symbol, by their number of letters.
    nouns: HashMap<usize, Vec<(String, &'static str)>>,
}

static LEXICON: LazyLock<Lexicon> = LazyLock::new(|| Lexicon::new(assets::words::LEXICON));

static ENGLISH: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let words = assets::words::ENGLISH.lines();
    words.filter(|w| !w.starts_with('#')).collect()
});

static THINGS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let words = assets::words::THINGS.lines();
    words.filter(|w| !w.starts_with('#')).collect()
});

/// True for a noun, singular or plural, of something that no scene holds.
pub fn is_other_thing(word: &str) -> bool {
    let is = |w: &str| THINGS.binary_search(&w).is_ok();
    let one = [word.strip_suffix("es"), word.strip_suffix('s')];
    is(word) || one.into_iter().flatten().any(is)
}

/// True for an English word, whether or not it means anything here; the list begins at three letters.
pub fn is_english(word: &str) -> bool {
    ENGLISH.binary_search(&word).is_ok()
}

impl Lexicon {
    /// The lexicon that ships with the program.
    pub fn bundled() -> &'static Self {
        &LEXICON
    }

    fn new(text: &'static str) -> Self {
        let mut out = Self {
            senses: HashMap::new(),
            units: HashMap::new(),
            ids: HashMap::new(),
            nouns: HashMap::new(),
        };
        let lines = text.lines().filter(|l| !l.starts_with('#'));
        for (key, words) in lines.filter_map(|l| l.split_once(": ")) {
            let Some((kind, symbol)) = key.split_once(' ') else {
                continue;
            };
            for word in words.split(", ") {
                if matches!(kind, "unit" | "speed") {
                    if let Ok(times) = symbol.parse() {
                        let is_speed = kind == "speed";
                        out.units.insert(word.to_owned(), Unit { times, is_speed });
                    }
                    continue;
                }
                let mut forms = word.split('/');
                let Some(one) = forms.next() else { continue };
                let mut add = |form: &str, many: bool| {
                    let sense = Sense { kind, symbol, many };
                    out.senses.entry(form.to_owned()).or_default().push(sense);
                };
                add(one, false);
                let mut many: Vec<String> = forms.map(str::to_owned).collect();
                if many.is_empty() && matches!(kind, "noun" | "group" | "place") {
                    many.push(plural(one));
                }
                many.iter().for_each(|form| add(form, true));
            }
        }
        let all: BTreeSet<Sense> = out.senses.values().flatten().cloned().collect();
        out.ids = all.into_iter().zip(1..).collect();
        for (word, senses) in out.senses.iter().filter(|(w, _)| !w.contains(' ')) {
            for s in senses.iter().filter(|s| s.kind == "noun") {
                let of = out.nouns.entry(word.chars().count()).or_default();
                of.push((word.clone(), s.symbol));
            }
        }
        out
    }

    /// Senses of a phrase, in the order of the file.
    pub fn senses(&self, phrase: &str) -> Option<&[Sense]> {
        self.senses.get(phrase).map(Vec::as_slice)
    }

    /// The unit that a phrase names.
    pub fn unit(&self, phrase: &str) -> Option<Unit> {
        self.units.get(phrase).copied()
    }

    /// Number of a sense in the reader network, from 1.
    pub fn id(&self, sense: &Sense) -> usize {
        self.ids.get(sense).copied().unwrap_or(0)
    }

    /// Number of senses.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// True if there are no senses.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Words of a similar length that name a kind of thing, each with its symbol.
    pub fn nouns_near(&self, word: &str) -> impl Iterator<Item = (&str, &'static str)> {
        let n = word.chars().count();
        let lists = [n.saturating_sub(1), n, n + 1];
        let found = lists.into_iter().filter_map(|n| self.nouns.get(&n));
        found.flatten().map(|(w, s)| (w.as_str(), *s))
    }

    /// Phrases of one word.
    pub fn single_words(&self) -> impl Iterator<Item = &str> {
        self.senses
            .keys()
            .map(String::as_str)
            .filter(|w| !w.contains(' '))
    }
}

/// The plural of a phrase by rule.
pub fn plural(phrase: &str) -> String {
    let (head, last) = phrase.rsplit_once(' ').unwrap_or(("", phrase));
    let sibilant = ["s", "x", "z", "ch", "sh"].iter().any(|end| last.ends_with(end));
    let consonant_y = last
        .strip_suffix('y')
        .is_some_and(|w| !w.is_empty() && !w.ends_with(['a', 'e', 'i', 'o', 'u']));
    let last = match (sibilant, consonant_y) {
        (true, _) => format!("{last}es"),
        (_, true) => format!("{}ies", &last[..last.len() - 1]),
        _ => format!("{last}s"),
    };
    if head.is_empty() {
        last
    } else {
        format!("{head} {last}")
    }
}
