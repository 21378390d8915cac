//! Words for time, weather, surroundings, roads, density, counts, colours, states and sizes.

use super::super::description::{Count, Density, Environment, Road, TimeOfDay, Weather};
use crate::scene::graph::{ObjectState, SizeHint};

/// Times of day.
pub const TIMES: &[(TimeOfDay, &str)] = &[
    (
        TimeOfDay::Night,
        "night|nighttime|night time|midnight|dark|darkness|nocturnal|late at night|after dark|nightly|moonlit|moonlight|pitch black|pitch dark|\
         in the dead of night|nightfall|small hours|late night|by night|starry|unlit|under street lights|at night|night scene|\
         overnight|after midnight|in the dark",
    ),
    (
        TimeOfDay::Dusk,
        "dusk|sunset|evening|twilight|sundown|golden hour|late afternoon|nightfall approaching|gloaming|early evening|setting sun|at dusk|low evening sun|sun sets|sun is setting",
    ),
    (
        TimeOfDay::Dawn,
        "dawn|sunrise|morning|daybreak|early morning|first light|rising sun|crack of dawn|sunup|at dawn|sun is rising|sun rises",
    ),
    (
        TimeOfDay::Day,
        "day|daytime|day time|noon|midday|mid day|afternoon|daylight|lunchtime|lunch time|broad daylight|in the daytime|by day|late morning|mid morning|middle of the day|noontime",
    ),
];

/// Weathers.
pub const WEATHERS: &[(Weather, &str)] = &[
    (
        Weather::Rain,
        "rain|rainy|raining|rains|rainfall|wet|drizzle|drizzly|drizzling|storm|stormy|thunderstorm|thunder|lightning|shower|showers|showery|downpour|pouring|\
         pouring rain|pours|pouring down|heavy rain|light rain|torrential|torrential rain|wet road|wet roads|wet street|wet streets|wet asphalt|puddles|soaked|damp|monsoon|cloudburst|\
         rain soaked|rain slick|slick|raindrops|hail|sleet|bucketing down|raining cats and dogs|raining heavily|heavy downpour|tropical storm|rainstorm|rain storm|drenched|slippery when wet",
    ),
    (
        Weather::Snow,
        "snow|snowy|snowing|snows|snowfall|blizzard|winter|wintry|snowstorm|snow storm|snow covered|snowflakes|snowed|icy|ice|frost|frosty|frozen|slush|slushy|winter day|\
         heavy snow|light snow|snowbound|wintery|falling snow|deep snow|flurries|freezing|snowed in",
    ),
    (
        Weather::Fog,
        "fog|foggy|mist|misty|haze|hazy|smog|smoggy|low visibility|poor visibility|dense fog|thick fog|foggy weather|murky|fogbound|bad visibility|pea soup|light fog|thick mist",
    ),
    (
        Weather::Sandstorm,
        "sandstorm|sand storm|dust|dusty|sandy|duststorm|dust storm|blowing sand|desert storm|haboob",
    ),
    (
        Weather::Overcast,
        "overcast|cloudy|clouds|grey|gray|grey sky|gray sky|grey skies|gloomy|dull|cloud cover|clouded|leaden sky|grey day|gray day|dreary|cloudy sky|partly cloudy|dark clouds|covered sky",
    ),
    (
        Weather::Clear,
        "sunny|clear|sun|bright|sunshine|blue sky|clear sky|clear skies|clear weather|fine weather|good weather|fair weather|dry|cloudless|bright day|sunlit|sunlight|bright sunshine|nice weather|brilliant sunshine|sun shines|sun is shining|summer day|summery|summer|hot|warm|\
         spring day|beautiful weather|dry weather|dry road",
    ),
];

/// Surroundings.
pub const ENVIRONMENTS: &[(Environment, &str)] = &[
    (
        Environment::Downtown,
        "downtown|city center|city centre|town centre|town center|inner city|central business district|business district|financial district|manhattan|city core|high street|shopping street|shopping district",
    ),
    (
        Environment::Urban,
        "urban|city|town|metropolitan|metropolis|boston|singapore|new york|london|tokyo|berlin|paris|san francisco|seattle|chicago|los angeles|munich|big city|chinatown|pittsburgh|las vegas",
    ),
    (
        Environment::Suburban,
        "suburban|suburb|suburbs|suburbia|outskirts",
    ),
    (
        Environment::Residential,
        "residential|residential area|residential street|residential road|residential neighbourhood|residential neighborhood|neighbourhood|neighborhood|housing estate|quiet residential|housing area|cul de sac|school zone",
    ),
    (
        Environment::Rural,
        "rural|countryside|village|country road|country lane|farmland|dirt road|gravel road|back road|farm road|outback",
    ),
    (
        Environment::Industrial,
        "industrial|industrial area|industrial estate|industrial zone|industrial park|docks|harbour|harbor|port|dockyard|logistics park",
    ),
    (
        Environment::Nature,
        "nature|woods|woodland|forested|mountains|mountainous|desert|coast|coastal|seaside|scenic|wilderness|national park|tree lined|leafy|hills|hilly",
    ),
];

/// Roads that are named without being a place.
pub const ROADS: &[(Road, Option<Environment>, &str)] = &[
    (
        Road::Straight,
        None,
        "straight road|straight street|straight|straight stretch|straight section|avenue|boulevard|long straight road|main road|main street|thoroughfare|ordinary street|city street|urban road|urban street|two way street|two way road",
    ),
    (
        Road::Curve,
        None,
        "curve|curved road|curving road|curved street|curved|curvy|curvy road|bend|bendy road|winding road|winding street|winding|road bends|road curves|sharp bend|serpentine|hairpin|hairpin bend|sharp turn|sharp curve|left hand bend|right hand bend|left bend|right bend|twisty road|twisting road|bending road",
    ),
    (
        Road::Highway,
        Some(Environment::Highway),
        "highway|motorway|freeway|expressway|interstate|autobahn|dual carriageway|turnpike|toll road|divided highway|multi lane highway|multi lane road|urban expressway|trunk road|autoroute|ring road|beltway|bypass|divided road",
    ),
    (
        Road::Suburb,
        Some(Environment::Suburban),
        "suburban street|suburban road|street with driveways|driveways|driveway|estate road",
    ),
    (
        Road::Suburb,
        Some(Environment::Residential),
        "residential street|residential road|side street with houses|quiet residential street",
    ),
    (
        Road::Suburb,
        Some(Environment::Rural),
        "country road|country lane|rural road|village road|village street|dirt road|gravel road|farm road",
    ),
];

/// How busy.
pub const DENSITIES: &[(Density, &str)] = &[
    (
        Density::Busy,
        "busy|crowded|heavy traffic|dense traffic|lots of traffic|a lot of traffic|much traffic|rush hour|rush hour traffic|bustling|hectic|packed|full of traffic|peak hour|peak hours|\
         lively|heavily trafficked|chaotic|high traffic|teeming|plenty of traffic|dense|busy traffic|full of cars and people|vibrant|thick traffic|heavily populated",
    ),
    (
        Density::Jam,
        "traffic jam|jam|congestion|congested|gridlock|gridlocked|bumper to bumper|bumper to bumper traffic|stop and go traffic|standstill|tailback|jammed|stationary traffic|standing traffic|clogged|slow moving traffic|stuck in traffic|backed up traffic|stop and go",
    ),
    (
        Density::Light,
        "light traffic|hardly any traffic|barely any traffic|not much traffic|very little traffic|next to no traffic|almost no traffic|little traffic|sparse traffic|low traffic|quiet|calm|moderate traffic|some traffic|a bit of traffic|few cars about|sparse|peaceful|normal traffic|medium traffic|sleepy|sparsely populated|average traffic",
    ),
    (
        Density::Empty,
        "empty|deserted|empty road|empty street|abandoned street|abandoned road|no traffic|without traffic|without any traffic|traffic free|lonely|no other traffic|vacant|\
         desolate|nothing else|no other vehicles|no other road users|free of traffic|car free|devoid of traffic|without other traffic|clear road|open road|without any other traffic|no traffic at all|nothing around|nothing in sight",
    ),
];

/// Counts in words: least, placed, most.
pub const COUNTS: &[(Count, &str)] = &[
    (
        Count { min: 1, n: 1, max: 1 },
        "one|single|a single|just one|only one|exactly one|a lone|lone|1|solitary|one single|a solitary|individual",
    ),
    (
        Count { min: 2, n: 2, max: 2 },
        "two|a couple of|a brace of|a twosome of|a pair|pair|couple of|a pair of|pair of|a couple|couple|twin|both|a duo of|two single|pairs of",
    ),
    (
        Count { min: 3, n: 3, max: 3 },
        "three|a trio of|a threesome of|trio of|trio|triple",
    ),
    (
        Count { min: 4, n: 4, max: 4 },
        "four|a quartet of|quartet of|a foursome of|fou",
    ),
    (Count { min: 5, n: 5, max: 5 }, "five"),
    (
        Count { min: 6, n: 6, max: 6 },
        "six|half a dozen|half a dozen of|half dozen|a half dozen|a half dozen of",
    ),
    (Count { min: 7, n: 7, max: 7 }, "seven"),
    (Count { min: 8, n: 8, max: 8 }, "eight"),
    (Count { min: 9, n: 9, max: 9 }, "nine"),
    (
        Count {
            min: 10,
            n: 10,
            max: 10,
        },
        "ten",
    ),
    (
        Count {
            min: 11,
            n: 11,
            max: 11,
        },
        "eleven",
    ),
    (
        Count {
            min: 12,
            n: 12,
            max: 12,
        },
        "twelve|a dozen|one dozen|dozen|a dozen of",
    ),
    (
        Count {
            min: 13,
            n: 13,
            max: 13,
        },
        "thirteen",
    ),
    (
        Count {
            min: 14,
            n: 14,
            max: 14,
        },
        "fourteen",
    ),
    (
        Count {
            min: 15,
            n: 15,
            max: 15,
        },
        "fifteen",
    ),
    (
        Count {
            min: 16,
            n: 16,
            max: 16,
        },
        "sixteen",
    ),
    (
        Count {
            min: 17,
            n: 17,
            max: 17,
        },
        "seventeen",
    ),
    (
        Count {
            min: 18,
            n: 18,
            max: 18,
        },
        "eighteen",
    ),
    (
        Count {
            min: 19,
            n: 19,
            max: 19,
        },
        "nineteen",
    ),
    (
        Count {
            min: 20,
            n: 20,
            max: 20,
        },
        "twenty|a score of",
    ),
    (
        Count {
            min: 24,
            n: 24,
            max: 24,
        },
        "two dozen",
    ),
    (
        Count {
            min: 30,
            n: 30,
            max: 30,
        },
        "thirty",
    ),
    (
        Count {
            min: 40,
            n: 40,
            max: 40,
        },
        "forty",
    ),
    (
        Count {
            min: 50,
            n: 50,
            max: 50,
        },
        "fifty",
    ),
    (
        Count {
            min: 100,
            n: 100,
            max: 100,
        },
        "hundred|a hundred|one hundred",
    ),
    (
        Count {
            min: 1000,
            n: 1000,
            max: 1000,
        },
        "thousand|a thousand|one thousand|a million|million",
    ),
    (
        Count { min: 2, n: 3, max: 5 },
        "some|a couple or three|two or three|one or two|a smattering of|a sprinkling of|a scattering of|a selection of|a knot of|a huddle of|a gaggle of|a bevy of|the odd|quite a few|a good few|a party of|party of|a band of|a squad of|a crew of|a batch of|batch of|a handful|a few|few|a handful of|handful of|a number of|various|a small number of|different|assorted|a bunch of|bunch of|multiple|several|a small group of|a set of|set of|more than one|a group of|group of|groups of|a cluster of|cluster of|clusters of|a small crowd of|a series of|a mix of|a pack of|a gang of|a string of|string of|a team of|team of",
    ),
    (
        Count { min: 3, n: 4, max: 8 },
        "a row of|row of|file of|a file of|a train of|an array of|a stretch of|a bank of|a stack of|a caravan of|a tailback of|tailback of|a pile up of|a pile of|pile of|a clump of|a wall of|rows of|a line of|line of|lines of|a queue of|queue of|queues of|a column of|column of|a convoy of|convoy of|a chain of|a fleet of|fleet of|a large group of|large group of|a procession of",
    ),
    (
        Count {
            min: 5,
            n: 8,
            max: 20,
        },
        "many|lots of|lots and lots of|a whole lot of|oodles of|no end of|a sea of|an army of|a ton of|a load of|a whole bunch of|a good number of|no shortage of|umpteen|scads of|ever so many|a lot of|a large number of|large number of|numerous|plenty of|loads of|countless|a crowd of|crowds of|crowd of|tons of|heaps of|a swarm of|dozens of|hordes of|a great many|an abundance of|a great number of|masses of|scores of|a multitude of|a host of|so many|too many|full of|lined with|packed with|crowded with|filled with|a throng of|tens of|a long line of|a long queue of|a long row of|littered with|swarming with",
    ),
];

/// Colours; they name no geometry.
pub const COLORS: &str = "red|blue|green|yellow|white|black|grey|gray|silver|orange|brown|purple|pink|golden|gold|beige|dark blue|dark red|dark green|dark grey|light blue|light green|maroon|navy|navy blue|turquoise|violet|cream|tan|crimson|burgundy|bright red|bright yellow|teal|cyan|magenta|lime|metallic|dark gray|light grey|bright orange|bronze|colourful|colorful|multicoloured|cherry red";

/// States. The second is true for finite verbs, which speak of the subject of the clause.
pub const STATES: &[(ObjectState, bool, &str)] = &[
    (
        ObjectState::Parked,
        false,
        "parked|parking|parked up|abandoned|double parked|broken down|stalled|left standing|parked illegally|illegally parked|badly parked|disabled|crashed|unoccupied|neatly parked",
    ),
    (
        ObjectState::Parked,
        true,
        "parks|is parked|are parked|sits parked|stands parked|stand parked|park",
    ),
    (
        ObjectState::Waiting,
        false,
        "waiting|stopped|stationary|standing|standing still|idling|idle|halted|queuing|queueing|queued|stopping|sitting|motionless|halting|lined up|lingering|resting|pausing|waiting to go|stuck|at a standstill|loitering|unmoving|static|\
         not moving|waiting in line|yielding|giving way|lying|placed|positioned|set up|arranged|laid out|put up|standing around|hanging around|gathered|gathering|assembled|chatting|talking|queued up",
    ),
    (
        ObjectState::Waiting,
        true,
        "waits|wait|stops|stands|stand|stopped dead|sits|sit|idles|queues|queue up|has stopped|have stopped|is stopped|are stopped|is standing|are standing|is waiting|are waiting|lies|lie|linger|lingers|yields|rests|has halted",
    ),
    (
        ObjectState::Moving,
        false,
        "moving|driving|travelling|traveling|cruising|passing|rolling|racing|speeding|running|walking|riding|cycling|jogging|strolling|overtaking|merging|accelerating|braking|reversing|backing up|\
         pedalling|pedaling|biking|hurrying|wandering|in motion|on the move|going|sprinting|marching|passing by|driving by|driving past|walking by|heading|crawling|coming|braking hard|pulling out|pulling over|u turning|changing lanes|turning|turning left|turning right|\
         making a left turn|making a right turn|making a u turn|zooming|swerving|rushing|weaving|skateboarding|skating|entering|leaving|exiting|pushing a pram|pushing a stroller|walking a dog|walking their dog|walking his dog|walking her dog|walking dogs|approaching slowly|cutting in|slowing down",
    ),
    (
        ObjectState::Moving,
        true,
        "moves|move along|drives|drive|travels|travel|passes|pass|rides|ride|walks|walk|runs|run|jogs|jog|cycles past|strolls|stroll|cruises|cruise|overtakes|overtake|merges|turns left|turns right|turn left|turn right|brakes|brake|goes|speeds|speed past|\
         races|race past|rolls|heads|crawls|crawls along|trundles|is moving|are moving|is driving|are driving|is walking|are walking|is running|are running|is riding|are riding|pulls out|pull out|comes|reverses|accelerates|hurries|wanders|wander|is turning|are turning|enters|enter|leaves|exits",
    ),
];

/// Sizes.
pub const SIZES: &[(SizeHint, &str)] = &[
    (
        SizeHint::Large,
        "big|large|huge|long|tall|giant|massive|enormous|heavy|bulky|oversized|wide|full size|full sized|extra long|gigantic|heavy duty|stretch|high|bigger|larger",
    ),
    (
        SizeHint::Small,
        "small|little|tiny|short|mini|miniature|compact sized|petite|smaller|low",
    ),
];

/// Attributes that are kept in words.
pub const ATTRIBUTES: &str = "slow|slowly|fast|quickly|slow moving|fast moving|old|new|young|elderly|modern|vintage|classic|luxury|expensive|cheap|rusty|damaged|electric|autonomous|\
    yellow and black|striped|loaded|unloaded|delivery|police|emergency|fire|private|commercial|public|electric powered|careful|carefully|drunk|distracted|cautious|cautiously|aggressive|aggressively|reckless|recklessly|slower|faster|dark coloured|light coloured|sporty|fancy|dirty|clean|shiny|battered|wrecked|wet looking|open|closed|loud|quietly|gently|nervous|hooded|tired|lost|careless|orange and white|red and white|concrete|plastic|wooden|metal|full|local|regular|ordinary|normal|typical|standard|plain";
