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
    /// Exchanges the places of two; no word of its own.
    Swap,
    /// Nothing: what is spoken of is only remembered.
    Note,
}

/// Imperatives.
pub const VERBS: &[(Verb, &str)] = &[
    (
        Verb::Remove,
        "despawn|unspawn|purge|strike|ban|prohibit|outlaw|forget|skip|never mind|dump|axe|junk|oust|expel|shoo|shoo away|tow away|tow off|tow|haul away|haul off|cart off|cart away|send away|send off|send home|whisk away|whisk off|pack off|boot out|boot|lift out|lift off|lift away|pluck out|pluck|take down|tear down|dismantle|clear up|clear off|free|rid|get off|let go of|get shot of|put away|shut out|weed out|root out|pick off|obliterate|annihilate|destroy|demolish|abolish|bulldoze|terminate|zap|scratch|spare me|unload|deduct|withdraw|retire|retract|undo|cross out|cross off|edit out|crop out|blot out|rule out|leave out|leave off|dismiss|detach|dispense with|part with|jettison|offload|yank|yank out|rip out|extract|expunge|eradicate|exterminate|disappear|dissolve|fade out|empty|depopulate|vacuum|hoover up|chase away|chase off|drive away|drive off|drive out|trim away|trim off|make away with|make vanish|make go away|relieve the scene of|wave off|see off|knock off|knock out|fling out|toss|toss out|toss away|chop|slash|nuke|exile|deport|send packing|evacuate|take|remove|delete|bin|ditch|chuck out|chuck|kick out|kick|strip out|strip|purge|clear away|sweep away|wipe away|pull out|nix|drop off|get rid|banish|evict|exclude|omit|vanish|make disappear|take off|trash|cull|do away with|rid the scene of|erase|get rid of|take out|take away|eliminate|drop out|cut out|kill|discard|dispose of|wipe out|wipe|scrap|lose|hide|rub out|throw out|strike|cancel|unplace|subtract",
    ),
    (
        Verb::Add,
        "slip a|slip one|slip another|slip two|tuck a|tuck one|tuck another|tuck two|sneak a|sneak another|nestle a|give me|get me|bring me|fetch me|find me|drop in|slot in|squeeze in|send in|dispatch|deploy|create|generate|show|include|append|attach|lay|lay out|build|raise up|conjure|conjure up|materialise|materialize|grow|supply|provide|furnish|complement|supplement|augment with|top up with|slip in|sprinkle|scatter|distribute|arrange|line up|let in|let enter|squeeze|fit in|fit|wedge|slide in|bring along|call up|construct|assemble|mount|establish|station|stand|seat|sit|leave a|leave two|put up|put down|put out|set down|set out|lay down|hang|post|feature|enrich with|bring into play|toss in|chuck in|plonk|plop|plunk|plonk down|shove in|inject|incorporate|bring back|spawn in|roll in|fetch|mark out|erect|have another|throw in some|add|insert|put|add in|add on|make room for|erect|pop|bring up|bring on|call in|place|spawn|drop|introduce|bring in|populate|throw in|put in|plant|install|position|stick|set up|park a|park two|give us|duplicate|let there be",
    ),
    (
        Verb::Move,
        "guide|steer|lead|haul over|lug|hoist|transport|transpose|migrate|pull back|pull forward|push back|push forward|push over|set back|move over|move up|move back|shuffle|edge|ease|inch|walk|reseat|re position|re locate|park the|park that|park my|park both|pop over|shove over|nudge over|rearrange|draw|convey|ship|usher|drive|drive over|direct|hurl|fling|haul|manoeuvre|maneuver|scoot over|dislocate|swap places with|put the|place the|put back|put both|put that|put my|set the|move|shift|push|shove|budge|slide over|scoot|roll|place over|carry|take across|swing|back up|pull|slide|drag|nudge|relocate|displace|bring|transfer|translate|reposition|send|advance",
    ),
    (
        Verb::Turn,
        "pivot|point|aim|revolve|twist|about face|orientate|redirect|realign|align|angle|wheel round|wheel around|turn round|turn around|spin round|spin around|reverse|turn|rotate|spin|swivel|face|flip|reorient|orient",
    ),
    (
        Verb::Replace,
        "make way for|change over|change into|turn into|upgrade|downgrade|switch for|supplant|supersede|swap over|trade in|barter|make into|mutate|transmute|reshape|refashion|remodel|rework|redo|metamorphose|interchange|alternate|replace|swap|substitute|trade|switch out|change out|morph|exchange|convert|transform|swap out",
    ),
    (
        Verb::Paint,
        "respray|spray|spray paint|repaint in|tone|shade|stain|paint|recolour|recolor|colour|color|repaint|dye|tint",
    ),
    (
        Verb::Keep,
        "preserve|save|hold|maintain|only retain|retain only|stick to|confine|cap|whittle down|pare down|pare|thin out|thin|scale down|scale back|scale up|slim down|lessen|diminish|decrease|shrink|cut back|cut|boost|up|augment|multiply|keep|leave|only keep|only leave|just keep|just leave|reduce|lower|cut to|trim|bring down|bump|raise|increase|bring up to|limit|restrict|retain|cut down",
    ),
    (
        Verb::Make,
        "render|force|order|tell|ask|cause|allow|permit|switch over|switch to|modify|edit|tweak|amend|revise|turn on|switch on|put on|make|set|change|switch|let|turn it|make it|set it|get|i want it|alter|adjust",
    ),
    (
        Verb::Clear,
        "sweep|tidy up|tidy|unblock|open up|free up|clear|empty out|clear out|clean up|vacate",
    ),
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
        "nearer of the two|nearer of the|closer of the two|closer of the|nearer one of the|nearer one|closer one|nearest of the|closest of the|nearest|closest|nearest to me|closest to me|nearest to us|closest to us|nearest to the ego|closest by|nearest one|closest one",
    ),
    (
        Pick::Farthest,
        "farther of the two|farther of the|further of the two|further of the|more distant of the two|more distant|farther one|further one|farthest of the|furthest of the|farthest|furthest|remotest|furthest from me|farthest from me|furthest off|most remote|furthest out|farthest out|furthest from us|most distant|farthest away|furthest away",
    ),
    (
        Pick::Leftmost,
        "left one of the|left hand one of the|left of the two|leftmost of the|left one|leftmost|left most|furthest left|farthest left",
    ),
    (
        Pick::Rightmost,
        "right one of the|right hand one of the|right of the two|rightmost of the|right one|rightmost|right most|furthest right|farthest right",
    ),
    (Pick::Frontmost, "frontmost|foremost|front most|front one"),
    (
        Pick::Rearmost,
        "rearmost|hindmost|backmost|rear most|rear one|back one|hind one",
    ),
    (
        Pick::Largest,
        "bigger of the two|larger of the two|bigger of the|larger of the|biggest of the|largest of the|biggest|largest|longest|tallest",
    ),
    (
        Pick::Smallest,
        "smaller of the two|smaller of the|smallest of the|smallest|shortest|tiniest",
    ),
    (
        Pick::Any,
        "any|any one|some random|a random|random|any of the|one of the|any one of the|whichever",
    ),
    (Pick::More, "more|extra|additional|further|another"),
];
