//! Words of commands to a scene.

/// What a command does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    /// Takes away.
    Remove,
    /// Puts in.
    Add,
    /// Moves.
    Move,
    /// Turns.
    Turn,
    /// Puts one in the other's place.
    Replace,
    /// Colours.
    Paint,
    /// Keeps so many.
    Keep,
    /// Makes, sets, changes.
    Make,
    /// Takes all away but.
    Clear,
}

/// Imperatives.
pub const VERBS: &[(Verb, &str)] = &[
    (
        Verb::Remove,
        "take|remove|delete|bin|ditch|chuck out|chuck|kick out|kick|strip out|strip|purge|clear away|sweep away|wipe away|pull out|nix|drop off|get rid|banish|evict|exclude|omit|vanish|make disappear|take off|trash|cull|do away with|rid the scene of|erase|get rid of|take out|take away|eliminate|drop out|cut out|kill|discard|dispose of|wipe out|wipe|scrap|lose|hide|rub out|throw out|strike|cancel|unplace|subtract",
    ),
    (
        Verb::Add,
        "add|insert|put|add in|add on|make room for|erect|pop|bring up|bring on|call in|place|spawn|drop|introduce|bring in|populate|throw in|put in|plant|install|position|stick|set up|park a|park two|give us|duplicate|let there be",
    ),
    (
        Verb::Move,
        "move|shift|push|shove|budge|slide over|scoot|roll|place over|carry|take across|swing|back up|pull|slide|drag|nudge|relocate|displace|bring|transfer|translate|reposition|send|advance",
    ),
    (Verb::Turn, "turn|rotate|spin|swivel|face|flip|reorient|orient"),
    (
        Verb::Replace,
        "replace|swap|substitute|trade|switch out|change out|morph|exchange|convert|transform|swap out",
    ),
    (
        Verb::Paint,
        "paint|recolour|recolor|colour|color|repaint|dye|tint",
    ),
    (
        Verb::Keep,
        "keep|leave|only keep|only leave|just keep|just leave|reduce|lower|cut to|trim|bring down|bump|raise|increase|bring up to|limit|restrict|retain|cut down",
    ),
    (
        Verb::Make,
        "make|set|change|switch|let|turn it|make it|set it|get|i want it|alter|adjust",
    ),
    (Verb::Clear, "clear|empty out|clear out|clean up|vacate"),
];

/// Which one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// All of them.
    All,
    /// Nearest to the ego vehicle.
    Nearest,
    /// Farthest from it.
    Farthest,
    /// Farthest left of it.
    Leftmost,
    /// Farthest right of it.
    Rightmost,
    /// Farthest forward.
    Frontmost,
    /// Farthest back.
    Rearmost,
    /// Longest.
    Largest,
    /// Shortest.
    Smallest,
    /// Any one.
    Any,
    /// So many more.
    More,
}

/// Words for them.
pub const PICKS: &[(Pick, &str)] = &[
    (
        Pick::All,
        "all|every|each of the|all of the|all the|all of|every single|every one of the",
    ),
    (
        Pick::Nearest,
        "nearest|closest|nearest to me|closest to me|nearest to us|closest to us|nearest to the ego|closest by|nearest one|closest one",
    ),
    (
        Pick::Farthest,
        "farthest|furthest|remotest|furthest from me|farthest from me|furthest off|most remote|furthest out|farthest out|furthest from us|most distant|farthest away|furthest away",
    ),
    (Pick::Leftmost, "leftmost|left most|furthest left|farthest left"),
    (
        Pick::Rightmost,
        "rightmost|right most|furthest right|farthest right",
    ),
    (Pick::Frontmost, "frontmost|foremost|front most|front one"),
    (Pick::Rearmost, "rearmost|hindmost|backmost|rear most"),
    (Pick::Largest, "biggest|largest|longest|tallest"),
    (Pick::Smallest, "smallest|shortest|tiniest"),
    (
        Pick::Any,
        "any|any one|some random|a random|random|any of the|one of the|any one of the|whichever",
    ),
    (Pick::More, "more|extra|additional|further|another"),
];
