//! The words of sentences about the background, with their meanings.

use place::beside_road::{SceneryKind, Verb};
use scene::background::{LineKind, PostKind, TreeKind};
use world::scenery::RoadsideKind;

/// Meaning of a run of words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Word {
    Verb(Verb),
    /// The thing, and whether the word is a plural.
    What(SceneryKind, bool),
    Left,
    Right,
    Both,
    Ahead,
    Behind,
    Near,
    Crossing,
    Junction,
    Me,
    Road,
    Along,
    A,
    The,
    No,
    All,
    Number(f64),
    Tall,
    Low,
    Taller,
    Lower,
    Dense,
    Sparse,
    Nearest,
    Furthest,
    Row,
    Storey,
    Metre,
    By,
    To,
    Filler,
}

macro_rules! table {
    ($($words:literal => $word:expr),+ $(,)?) => { &[$(($words, $word)),+] };
}

use RoadsideKind::*;
use SceneryKind::*;
use Word as W;

/// Words by their meaning, separated by `|`.
const TABLE: &[(&str, Word)] = table! {
    "remove|delete|erase|cut down|chop down|fell|demolish|tear down|take away|take out|get rid of|clear|drop|knock down" => W::Verb(Verb::Remove),
    "add|plant|build|put|place|insert|draw|erect|set up|create" => W::Verb(Verb::Add),
    "raise|heighten|increase|extend" => W::Verb(Verb::Raise),
    "shorten|trim|reduce" => W::Verb(Verb::Lower),
    "make|let" => W::Verb(Verb::Make),
    "move|shift|push" => W::Verb(Verb::Move),

    "building" => W::What(Building(None), false),
    "buildings|architecture" => W::What(Building(None), true),
    "house|villa|bungalow|cottage" => W::What(Building(Some(Suburb)), false),
    "houses|homes|villas|bungalows|cottages|suburban houses|family houses|detached houses" => W::What(Building(Some(Suburb)), true),
    "apartment building|apartment block|apartment house|block of flats|office building|office tower|tower|tower block|skyscraper|high rise|high rise building|city building" => W::What(Building(Some(City)), false),
    "apartments|apartment buildings|apartment blocks|apartment houses|blocks of flats|office buildings|offices|office towers|towers|tower blocks|skyscrapers|high rises|high rise buildings|city buildings" => W::What(Building(Some(City)), true),
    "warehouse|factory|hall|industrial building|factory building" => W::What(Building(Some(Industry)), false),
    "warehouses|factories|halls|industrial buildings|factory buildings" => W::What(Building(Some(Industry)), true),
    "shop|store|supermarket|shopping center|shopping centre|mall" => W::What(Building(Some(Retail)), false),
    "shops|stores|supermarkets|malls" => W::What(Building(Some(Retail)), true),
    "old house|old building|half timbered house|townhouse|terraced house|row house" => W::What(Building(Some(OldTown)), false),
    "old houses|old buildings|half timbered houses|townhouses|terraced houses|row houses" => W::What(Building(Some(OldTown)), true),
    "farm|barn|farmhouse" => W::What(Building(Some(Country)), false),
    "farms|barns|farmhouses" => W::What(Building(Some(Country)), true),

    "tree" => W::What(Tree(None), false),
    "trees" => W::What(Tree(None), true),
    "conifer|fir|fir tree|pine|pine tree|spruce" => W::What(Tree(Some(TreeKind::Conifer)), false),
    "conifers|firs|fir trees|pines|pine trees|spruces" => W::What(Tree(Some(TreeKind::Conifer)), true),
    "poplar|poplar tree|cypress" => W::What(Tree(Some(TreeKind::Columnar)), false),
    "poplars|poplar trees|cypresses" => W::What(Tree(Some(TreeKind::Columnar)), true),
    "bare tree|leafless tree|dead tree" => W::What(Tree(Some(TreeKind::Bare)), false),
    "bare trees|leafless trees|dead trees" => W::What(Tree(Some(TreeKind::Bare)), true),
    "oak|oak tree|maple|beech|birch|lime tree|chestnut tree" => W::What(Tree(Some(TreeKind::Broadleaf)), false),
    "oaks|oak trees|maples|beeches|birches|lime trees|chestnut trees" => W::What(Tree(Some(TreeKind::Broadleaf)), true),
    "shrub|bush" => W::What(Shrubs, false),
    "shrubs|bushes|undergrowth|shrubbery|scrub" => W::What(Shrubs, true),
    "vegetation|greenery|plants" => W::What(Plants, true),

    "hedge|hedgerow" => W::What(Line(LineKind::Hedge), false),
    "hedges|hedgerows" => W::What(Line(LineKind::Hedge), true),
    "wall|garden wall" => W::What(Line(LineKind::Wall), false),
    "walls|garden walls" => W::What(Line(LineKind::Wall), true),
    "fence|railing" => W::What(Line(LineKind::Fence), false),
    "fences|railings|fencing" => W::What(Line(LineKind::Fence), true),
    "guard rail|guardrail" => W::What(Line(LineKind::GuardRail), false),
    "guard rails|guardrails" => W::What(Line(LineKind::GuardRail), true),

    "pole|mast|utility pole" => W::What(Post(PostKind::Pole), false),
    "poles|masts|utility poles" => W::What(Post(PostKind::Pole), true),
    "street light|streetlight|street lamp|lamp post|lamppost|lamp" => W::What(Post(PostKind::StreetLight), false),
    "street lights|streetlights|street lamps|lamp posts|lampposts|lamps" => W::What(Post(PostKind::StreetLight), true),
    "bus stop|bus shelter" => W::What(Post(PostKind::BusStop), false),
    "bus stops|bus shelters" => W::What(Post(PostKind::BusStop), true),
    "bench|park bench" => W::What(Post(PostKind::Bench), false),
    "benches|park benches" => W::What(Post(PostKind::Bench), true),
    "bin|trash can|rubbish bin|garbage bin|litter bin" => W::What(Post(PostKind::Bin), false),
    "bins|trash cans|rubbish bins|garbage bins|litter bins" => W::What(Post(PostKind::Bin), true),
    "traffic light|signal mast" => W::What(Post(PostKind::TrafficLight), false),
    "traffic lights" => W::What(Post(PostKind::TrafficLight), true),
    "sign|traffic sign|road sign|street sign" => W::What(Post(PostKind::Sign), false),
    "signs|traffic signs|road signs|street signs" => W::What(Post(PostKind::Sign), true),

    "forest|wood|woods|woodland|grove" => W::What(Place(Forest), false),
    "field|fields|meadow|meadows|farmland|countryside|pasture" => W::What(Place(Country), false),
    "industrial area|industrial estate|industrial zone|industry|factory area" => W::What(Place(Industry), false),
    "suburb|suburbs|residential area|suburban area|housing estate|gardens" => W::What(Place(Suburb), false),
    "park|lawn|lawns|green space" => W::What(Place(Park), false),
    "shopping area|retail park|shopping street|car park|parking lot" => W::What(Place(Retail), false),
    "old town|old quarter" => W::What(Place(OldTown), false),
    "city blocks|downtown" => W::What(Place(City), false),
    "thing" => W::What(Thing, false),

    "left|left side|left hand side|left hand" => W::Left,
    "right|right side|right hand side|right hand" => W::Right,
    "both sides|both|either side|each side|left and right|left and right side|left and right sides" => W::Both,
    "ahead|in front|up ahead|in front of me|ahead of me|in front of us|ahead of us|in front of the car" => W::Ahead,
    "behind|at the back|behind me|behind us" => W::Behind,
    "near|close to|around|next to|at|beside|within|by the" => W::Near,
    "crossing|crossings|crosswalk|crosswalks|zebra crossing|pedestrian crossing|pedestrian crossings|zebra" => W::Crossing,
    "junction|intersection|crossroads|junctions|intersections" => W::Junction,
    "me|us|ego|ego vehicle|my car" => W::Me,
    "road|street|roadside|kerb|curb|sidewalk|pavement|verge|lane" => W::Road,
    "along|alongside|lining" => W::Along,
    "a|an|some|a few|several|another|one more|more|a couple of|a single" => W::A,
    "the|that|this|those|these" => W::The,
    "no|without|without any|not any|no more|none of the|zero" => W::No,
    "all|all the|all of the|every|every single|any|each" => W::All,
    "tall|high|big|large|huge|towering|multi storey|multistorey|multi story" => W::Tall,
    "low|small|short|little|flat|single storey|single story" => W::Low,
    "taller|higher|bigger" => W::Taller,
    "lower|shorter|smaller" => W::Lower,
    "dense|thick|many|lots of|a lot of|plenty of|deep|closed" => W::Dense,
    "sparse|scattered|light|thin|few|hardly any|open" => W::Sparse,
    "nearest|closest|next" => W::Nearest,
    "furthest|farthest|last" => W::Furthest,
    "row|rows|line|row of|rows of|line of|a row of|avenue of|lined with|alley of" => W::Row,
    "storey|storeys|story|stories|floor|floors|level|levels" => W::Storey,
    "m|metre|metres|meter|meters" => W::Metre,
    "by" => W::By,
    "to" => W::To,
    "on|of|in|from|with|is|are|there|there is|there are|should|should be|must be|be|side|please|scene|stand|stands|standing|grow|growing|place|area|away|just|then|now|apart|want|i want|i would like|can you|could you|to the" => W::Filler,
    "one|single" => W::Number(1.0),
    "two" => W::Number(2.0),
    "three" => W::Number(3.0),
    "four" => W::Number(4.0),
    "five" => W::Number(5.0),
    "six" => W::Number(6.0),
    "seven" => W::Number(7.0),
    "eight" => W::Number(8.0),
    "nine" => W::Number(9.0),
    "ten" => W::Number(10.0),
    "twelve" => W::Number(12.0),
    "twenty" => W::Number(20.0),
};

/// Longest run of words in the table.
const LONGEST: usize = 5;

/// Meaning and length of the longest run of the table at the head of `words`; `None` if no word of the table is there.
pub(super) fn lookup(words: &[&str]) -> Option<(Word, usize)> {
    (1..=LONGEST.min(words.len())).rev().find_map(|n| {
        let run = words[..n].join(" ");
        let found = TABLE.iter().find(|(list, _)| list.split('|').any(|w| w == run));
        found.map(|(_, word)| (*word, n))
    })
}
