//! Words for time, weather, surroundings, roads, density, counts, colours, states and sizes.

use super::super::description::{Count, Density, Environment, Road, TimeOfDay, Weather};
use crate::scene::graph::{ObjectState, SizeHint};

/// Times of day.
pub const TIMES: &[(TimeOfDay, &str)] = &[
    (
        TimeOfDay::Night,
        "night|nite|nighttime|by nightfall|after nightfall|past nightfall|since nightfall|black of night|dead of night|middle of the night|the middle of the night|wee hours|witching hour|early hours|early hours of the morning|night falls|night has fallen|nightfall has come|after sundown|after nightfall|past midnight|shortly before midnight|shortly after midnight|around midnight|stars are out|under the stars|starlight|starlit|starry sky|starry night|starless|moon|full moon|moonless|moonless night|moon shines|moon is out|moon is up|by moonlight|by lamplight|lamplight|lamplit|by streetlight|under streetlights|under street lamps|lit by street lamps|lit by streetlights|lit by lamps|lit only by headlights|street lamps are on|streetlights are on|street lights are on|lamps are lit|street lamps lit|streetlamps lit|headlights only|only headlights|headlights cut through|inky|inky black|inky darkness|jet black|coal black|black as pitch|pitch blackness|pitch darkness|black night|dark night|deep night|night shift|night drive|nighttime drive|nightlife|nocturne|no daylight|without daylight|unlit road|unlit street|dark outside|dark out|fully dark|completely dark|totally dark|long after dark|sun is long gone|sun has long set|headlamps on|bedtime|small hours of the morning|night time|midnight|dark|darkness|nocturnal|late at night|after dark|nightly|moonlit|moonlight|pitch black|pitch dark|\
         in the dead of night|small hours|late night|by night|starry|unlit|under street lights|at night|night scene|\
         overnight|after midnight|in the dark",
    ),
    (
        TimeOfDay::Dusk,
        "dusk|sun just going down|sun is just going down|sun just setting|sun is just setting|sun was going down|sun was setting|sun had just set|sun had just gone down|sun went down|sun was sinking|sun was low in the west|it was getting dark|nightfall|sunset|at sunset|at nightfall|sun going down|sun goes down|sun is going down|sun has just gone down|sun has just set|sun is sinking|sun sinks|sun sinking|sinking sun|sun dips|sun is dipping|sun is low in the west|sun sets slowly|sun is about to set|just before sunset|just after sunset|shortly before sunset|shortly after sunset|after sunset|last light|last light of day|last light of the day|last rays|last rays of the sun|last sunlight|fading light|fading daylight|failing light|dying light|waning light|light fades|light is fading|light is failing|daylight fades|daylight is fading|daylight fading|day is ending|end of the day|days end|close of day|blue hour|eventide|dusky|getting dark|gets dark|growing dark|turning dark|nearly dark|almost dark|darkness is falling|darkness falls|night is falling|night is coming|night approaches|nearly night|late in the day|late in the afternoon|evening rush hour|evening light|evening sun|evening glow|in the evening|this evening|crepuscular|sunset light|sunset glow|sun sits on the horizon|vespers|half light|low sun in the west|evening|twilight|sundown|golden hour|late afternoon|nightfall approaching|gloaming|early evening|setting sun|at dusk|low evening sun|sun sets|sun is setting",
    ),
    (
        TimeOfDay::Dawn,
        "dawn|sun is just rising|sun is rising|sun is coming up|sun is just coming up|day has broken|dawn has broken|day broke|dawns|dawned|day dawns|day breaks|day is breaking|dawn breaks|sun was coming up|sun was rising|sun had just come up|sun had just risen|sun came up|sun rose|sun peeks over the horizon|sun was about to rise|sunrise|at sunrise|before sunrise|just before sunrise|just after sunrise|shortly after sunrise|shortly before sunrise|sun is coming up|sun comes up|sun coming up|sun has just risen|sun has just come up|sun is about to rise|sun rising|sun rises slowly|as the sun rises|first rays|first rays of the sun|first sunlight|first light of day|first light of the day|break of day|break of dawn|day breaks|day is breaking|daybreak light|dawning|dawn breaks|dawn is breaking|cockcrow|at cockcrow|early in the morning|very early morning|morning light|morning sun|morning glow|morning twilight|morning rush hour|morning rush|in the morning|this morning|new day|getting light|grows light|growing light|light is growing|sunrise light|rosy sky|low sun in the east|start of the day|early riser|morning|daybreak|early morning|first light|rising sun|crack of dawn|sunup|at dawn|sun is rising|sun rises",
    ),
    (
        TimeOfDay::Day,
        "day|daytime|high noon|at noon|around noon|noonday|in daylight|by daylight|full daylight|in full daylight|bright daylight|daylight hours|day light|broad day|middle of a day|the middle of the day|forenoon|mid afternoon|early afternoon|sun overhead|sun is high|sun stands high|sun high in the sky|sun is overhead|high sun|at lunchtime|around lunchtime|lunch hour|lunch break|teatime|siesta|school run|office hours|working hours|business hours|morning break|midday sun|noon sun|afternoon sun|during the day|in the day|day time|noon|midday|mid day|afternoon|daylight|lunchtime|lunch time|broad daylight|in the daytime|by day|late morning|mid morning|middle of the day|noontime",
    ),
];

/// Weathers.
pub const WEATHERS: &[(Weather, &str)] = &[
    (
        Weather::Rain,
        "rain|rainy|rain falls|rain is falling|falling rain|rain comes down|rain pours|rain pours down|rain pelts|rain lashes|rain lashing|lashing rain|lashing down|pelting|pelting down|pelting rain|teeming down|teeming rain|driving rain|driving rain lashes|persistent rain|steady rain|constant rain|fine rain|slight rain|freezing rain|rain swept|rainswept|rain lashed|rain drenched|rain sodden|rain wet|rain shower|rain showers|heavy shower|summer rain|rain squall|squall|squally|deluge|mizzle|sprinkle|sprinkling|spitting|spits with rain|precipitation|tempest|thundery|thundery shower|thunderclouds|thunder rumbles|hailstorm|hailing|hailstones|sleety|sodden|sopping|soaking|soaking wet|dripping|dripping wet|wringing wet|waterlogged|flooded|flooding|water on the road|standing water|spray|windscreen wipers|windshield wipers|wipers|wipers on|wipers going|umbrellas up|tipping it down|chucking it down|tipping down|chucking down|throwing it down|hammering down|bucketing|belting down|sheeting down|coming down in sheets|coming down in buckets|sheets of rain|raining hard|rains hard|rains heavily|rained|has rained|it rained|wetness|wet weather|wet day|wet tarmac|wet surface|wet pavement|wet ground|wet carriageway|wet asphalt road|glistening wet|shiny wet|slick road|slick roads|slick with rain|slippery with rain|slippery from rain|rain glistens|rainclouds burst|pluvial|nasty wet|cats and dogs|pissing down|downpours|drizzles|drizzled|raindrop|raining|rains|rainfall|wet|drizzle|drizzly|drizzling|storm|stormy|thunderstorm|thunder|lightning|shower|showers|showery|downpour|pouring|\
         pouring rain|pours|pouring down|heavy rain|light rain|torrential|torrential rain|wet road|wet roads|wet street|wet streets|wet asphalt|puddles|soaked|damp|monsoon|cloudburst|\
         rain soaked|rain slick|slick|raindrops|hail|sleet|bucketing down|raining cats and dogs|raining heavily|heavy downpour|tropical storm|rainstorm|rain storm|drenched|slippery when wet",
    ),
    (
        Weather::Snow,
        "snow|snowy|snow falls|snow is falling|snow lies|snow is on the ground|snow on the ground|snow on the road|under snow|under a blanket of snow|blanket of snow|snow blanket|blanketed in snow|covered in snow|covered with snow|carpeted in snow|snow carpeted|layer of snow|thick snow|thin snow|fresh snow|freshly fallen snow|powder snow|powdery snow|snow powder|snow clad|snow capped|snow laden|snowdrift|snow drift|snow drifts|snowbank|snow bank|snow flakes|snowflake|snow flurry|snow flurries|snow shower|snow showers|snow squall|driving snow|drifting snow|blowing snow|whirling snow|swirling snow|snow swirls|snow whirls|flakes|flurry|whiteout|white out|blizzardy|blizzards|snowstorms|wintertime|winter weather|winters day|in winter|winter morning|winter evening|winter road|deep winter|hard frost|hoarfrost|hoar frost|ground frost|black ice|icy road|icy roads|icy street|ice covered|iced over|iced up|frozen over|frozen road|sub zero|below zero|below freezing|minus degrees|arctic|polar|snowplough weather|snowy road|snowed over|snowed under|snowing heavily|snowing hard|snows heavily|snowman weather|white with snow|christmas|slushy snow|snowing|snows|snowfall|blizzard|winter|wintry|snowstorm|snow storm|snow covered|snowflakes|snowed|icy|ice|frost|frosty|frozen|slush|slushy|winter day|\
         heavy snow|light snow|snowbound|wintery|falling snow|deep snow|flurries|freezing|snowed in",
    ),
    (
        Weather::Fog,
        "barely see a thing|can barely see a thing|cannot see a thing|cant see a thing|hardly see a thing|can hardly see a thing|see a thing|cant see beyond|cannot see beyond|cant see past|fog|foggy|fog bank|fog banks|fog patches|patchy fog|freezing fog|morning mist|mist hangs|fog hangs|mist hanging|fog hanging|fog rolls in|mist rolls in|fog lies|mist lies|shrouded in fog|shrouded in mist|wrapped in fog|wrapped in mist|blanketed in fog|blanket of fog|curtain of fog|wall of fog|sea of fog|dense mist|heavy fog|heavy mist|light mist|thin mist|misty morning|brume|vapour|vapor|hardly any visibility|visibility is poor|visibility is low|visibility is bad|visibility is limited|visibility is reduced|visibility is terrible|visibility is down|visibility is only|visibility poor|visibility low|visibility near zero|zero visibility|no visibility|almost no visibility|little visibility|limited visibility|reduced visibility|restricted visibility|terrible visibility|very low visibility|cannot see far|cant see far|can hardly see|can barely see|one can hardly see|you can hardly see|you can barely see|hardly see|barely see|obscured by haze|haze hangs|heat haze|smoky|smoke|smog hangs|foggy conditions|fogged in|fogged over|like soup|peasouper|pea souper|milky|milky air|mist|misty|haze|hazy|smog|smoggy|low visibility|poor visibility|dense fog|thick fog|foggy weather|murky|fogbound|bad visibility|pea soup|light fog|thick mist",
    ),
    (
        Weather::Sandstorm,
        "sandstorm|sand storm|dust cloud|dust clouds|clouds of dust|cloud of dust|clouds of sand|cloud of sand|dust devil|dust devils|dust swirls|dust is swirling|swirling dust|swirling sand|sand swirls|sand is blowing|sand blowing|sand blows|blowing dust|dust blowing|dust blows|flying sand|flying dust|airborne dust|airborne sand|dust in the air|sand in the air|sand laden wind|dust laden|desert wind|simoom|simoon|khamsin|sirocco|harmattan|sand|sands|sandstorms|dust filled|full of dust|dusty air|wall of dust|wall of sand|sand whipped|red dust|saharan dust|dust|dusty|sandy|duststorm|dust storm|blowing sand|desert storm|haboob",
    ),
    (
        Weather::Overcast,
        "overcast|cloudy|clouded over|cloudy day|cloud covered|cloud|cloudiness|clouds hang low|clouds hang|low clouds|low hanging clouds|low cloud|thick clouds|thick cloud|heavy clouds|heavy cloud|grey clouds|gray clouds|black clouds|storm clouds|rain clouds|leaden|leaden clouds|steel grey sky|slate grey sky|slate sky|sunless|no sun|without sun|sun is hidden|sun hidden|hidden sun|sky is grey|sky is gray|skies are grey|skies are gray|sky is covered|sky is overcast|drab|drab day|dismal|bleak|sombre|somber|murk|dim light|flat light|diffuse light|overcast sky|overcast day|overcast skies|dull day|dull light|dull sky|dull weather|dull skies|mostly cloudy|cloudy skies|cloudy weather|broken clouds|blanket of cloud|blanket of clouds|layer of cloud|covered with clouds|covered by clouds|under cloud|under clouds|under grey skies|under a grey sky|under gray skies|under a gray sky|under a leaden sky|without sunshine|no sunshine|clouds|grey|gray|grey sky|gray sky|grey skies|gloomy|dull|cloud cover|clouded|leaden sky|grey day|gray day|dreary|cloudy sky|partly cloudy|dark clouds|covered sky",
    ),
    (
        Weather::Clear,
        "rain stops|rain has stopped|rain ends|stops raining|stopped raining|snow stops|stops snowing|snowing stops|fog lifts|fog has lifted|mist lifts|mist clears|fog clears|fog clears up|weather clears|weather clears up|weather improves|weather is good|weather is fine|weather is nice|weather is clear|dries up|clear up|clears up|cleared up|sky clear up|sky has cleared|sky has cleared up|skies have cleared|sky cleared|sky cleared up|sky has brightened|sky brightens|sky is blue again|sky clears|sky clears up|skies clear|brightens up|brighten up|sun comes out|sun came out|sun breaks through|sunny|clear|sunny day|sunny weather|sunny morning sky|sunshiny|sun is out|sun is beating down|sun beats down|sun beating down|sun blazes|sun blazing|blazing sun|blazing sunshine|baking sun|scorching sun|scorching|baking hot|strong sun|strong sunlight|full sun|in full sun|full sunshine|glaring sun|glaring sunlight|glare|radiant|glorious|glorious weather|glorious day|gorgeous day|fair|fair day|fine day|fine and dry|bright and dry|dry and bright|dry and sunny|bone dry|dry conditions|dry surface|dry asphalt|dry tarmac|dry day|balmy|mild and dry|azure|azure sky|deep blue sky|bright blue sky|blue skies|under a blue sky|under blue skies|under a clear sky|under clear skies|skies are clear|sky is clear|sky is blue|clear day|clear blue sky|clear and dry|clear conditions|crystal clear|unclouded|cloud free|no clouds|without clouds|without a cloud|without a cloud in the sky|not a cloud|not a cloud in the sky|not a cloud in sight|not one cloud|isnt a cloud in the sky|is not a cloud in the sky|no cloud|no cloud in the sky|cloudless sky|cloudless day|bright sun|bright sunny|brilliant sun|brilliant weather|perfect weather|lovely weather|pleasant weather|nice day|beautiful day|good visibility|excellent visibility|perfect visibility|great visibility|heatwave|heat wave|sunlit street|sun drenched|sun kissed|sunbathed|summers day|summertime|warm weather|hot weather|hot day|warm day|sun|bright|sunshine|blue sky|clear sky|clear skies|clear weather|fine weather|good weather|fair weather|dry|cloudless|bright day|sunlit|sunlight|bright sunshine|nice weather|brilliant sunshine|sun shines|sun is shining|summer day|summery|summer|hot|warm|\
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
        "highway|motorway|freeway|expressway|interstate|autobahn|dual carriageway|turnpike|toll road|divided highway|multi lane highway|multi lane road|urban expressway|trunk road|autoroute|ring road|beltway|the bypass|bypass road|divided road",
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
        "busy|crowded|swarming|thronged|buzzing|frantic|rush hour crowds|heavy with traffic|thick with traffic|dense with traffic|choked with traffic|loaded with traffic|a great deal of traffic|heaps of traffic|loads of traffic|tons of traffic|full of life|jam packed|overcrowded|bursting|heavy traffic|dense traffic|lots of traffic|a lot of traffic|much traffic|rush hour|rush hour traffic|bustling|hectic|packed|full of traffic|peak hour|peak hours|\
         lively|heavily trafficked|chaotic|high traffic|teeming|plenty of traffic|dense|busy traffic|full of cars and people|vibrant|thick traffic|heavily populated",
    ),
    (
        Density::Jam,
        "traffic jam|jam|congestion|congested|gridlock|gridlocked|bumper to bumper|bumper to bumper traffic|stop and go traffic|standstill|tailback|jammed|stationary traffic|standing traffic|clogged|slow moving traffic|stuck in traffic|backed up traffic|stop and go",
    ),
    (
        Density::Light,
        "light traffic|thin traffic|traffic is light|traffic is thin|traffic is sparse|traffic is low|traffic is calm|few vehicles about|few vehicles around|few cars around|hardly any traffic|barely any traffic|not much traffic|very little traffic|next to no traffic|almost no traffic|little traffic|sparse traffic|low traffic|quiet|calm|moderate traffic|some traffic|a bit of traffic|few cars about|sparse|peaceful|normal traffic|medium traffic|sleepy|sparsely populated|average traffic",
    ),
    (
        Density::Empty,
        "empty|deserted|otherwise empty|otherwise deserted|otherwise quiet|is otherwise empty|nothing else around|nothing else about|nothing else is there|nothing else in sight|nobody else and nothing else|nothing more|no one and nothing else|no one else around|not a car in sight|abandoned|forsaken|desolated|unpopulated|traffic less|empty road|empty street|abandoned street|abandoned road|no traffic|without traffic|without any traffic|traffic free|lonely|no other traffic|vacant|\
         desolate|nothing else|no other vehicles|no other road users|free of traffic|car free|devoid of traffic|without other traffic|clear road|open road|without any other traffic|no traffic at all|nothing around|nothing in sight",
    ),
];

/// Counts in words: least, placed, most.
pub const COUNTS: &[(Count, &str)] = &[
    (
        Count { min: 1, n: 1, max: 1 },
        "one|single|a single|a sole|sole|precisely one|a lonely|no more than one|1x|one lone|one sole|one more|one and only one|one only|just one|only one|exactly one|a lone|lone|1|solitary|one single|a solitary|individual",
    ),
    (
        Count { min: 2, n: 2, max: 2 },
        "two|a couple of|precisely two|a set of two|a group of two|two of the|a duet of|a duo|duo of|two identical|a team of two|a party of two|a brace of|a twosome of|a pair|pair|couple of|a pair of|pair of|a couple|couple|twin|both|a duo of|two single|pairs of",
    ),
    (
        Count { min: 3, n: 3, max: 3 },
        "three|a trio of|a group of three|a set of three|a team of three|a party of three|three identical|trios of|triplet|triplets of|a threesome|a threesome of|trio of|trio|triple",
    ),
    (
        Count { min: 4, n: 4, max: 4 },
        "four|a quartet of|a group of four|a set of four|a team of four|a party of four|quartet|two pairs of|two couples of|quartet of|a foursome of|fou",
    ),
    (
        Count { min: 5, n: 5, max: 5 },
        "five|a group of five|a set of five|a team of five|a quintet of|quintet of|a party of five|a handful of five|a fivesome of",
    ),
    (
        Count { min: 6, n: 6, max: 6 },
        "six|half a dozen|a group of six|a set of six|a team of six|a sextet of|a sixsome of|half of a dozen|1/2 dozen|two trios of|half a dozen of|half dozen|a half dozen|a half dozen of",
    ),
    (
        Count { min: 7, n: 7, max: 7 },
        "seven|a group of seven|a set of seven|a septet of",
    ),
    (
        Count { min: 8, n: 8, max: 8 },
        "eight|a group of eight|a set of eight|an octet of",
    ),
    (
        Count { min: 9, n: 9, max: 9 },
        "nine|a group of nine|a set of nine",
    ),
    (
        Count {
            min: 10,
            n: 10,
            max: 10,
        },
        "ten|a group of ten|a set of ten",
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
        "twelve|a dozen|a full dozen|a round dozen|an even dozen|a group of twelve|one dozen|dozen|a dozen of",
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
            min: 60,
            n: 60,
            max: 60,
        },
        "sixty",
    ),
    (
        Count {
            min: 70,
            n: 70,
            max: 70,
        },
        "seventy",
    ),
    (
        Count {
            min: 80,
            n: 80,
            max: 80,
        },
        "eighty",
    ),
    (
        Count {
            min: 90,
            n: 90,
            max: 90,
        },
        "ninety",
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
pub const COLORS: &str = "red|scarlet|ruby|rust coloured|rust colored|vermilion|coral|salmon|rose|fuchsia|lilac|lavender|mauve|plum|indigo|sky blue|royal blue|baby blue|ice blue|aquamarine|aqua|emerald|olive|khaki|mint|mint green|forest green|bottle green|mustard|amber|ochre|sand coloured|ivory|off white|pearl|chrome|charcoal|anthracite|gunmetal|graphite|ebony|jet black|chocolate|hazel|copper|champagne|two tone|camouflage|camo|navy coloured|dark coloured|pale|pale blue|pale green|pale yellow|bright green|bright blue|neon yellow|neon|fluorescent|high visibility|hi viz|hi vis|high vis|blue|green|yellow|white|black|grey|gray|silver|orange|brown|purple|pink|golden|gold|beige|dark blue|dark red|dark green|dark grey|light blue|light green|maroon|navy|navy blue|turquoise|violet|cream|tan|crimson|burgundy|bright red|bright yellow|teal|cyan|magenta|lime|metallic|dark gray|light grey|bright orange|bronze|colourful|colorful|multicoloured|cherry red";

/// States. The second is true for finite verbs, which speak of the subject of the clause.
pub const STATES: &[(ObjectState, bool, &str)] = &[
    (
        ObjectState::Parked,
        false,
        "parked|parking|parked there|left behind|immobilised|immobilized|out of order|out of service|out of action|beached|dumped|left unattended|unattended|with its engine off|with the engine off|engine off|switched off|driverless|empty and parked|deserted and parked|double parking|at the kerbside parked|garaged|laid up|berthed|conked out|defunct|parked up|abandoned|double parked|broken down|stalled|left standing|parked illegally|illegally parked|badly parked|disabled|crashed|unoccupied|neatly parked",
    ),
    (
        ObjectState::Parked,
        true,
        "has pulled over|have pulled over|had pulled over|has pulled in|have pulled in|had pulled in|is pulled over|are pulled over|was pulled over|were pulled over|pulled over|pulled in|has parked|have parked|had parked|was parked|were parked|parks|is parked|are parked|sits parked|stands parked|stand parked|park",
    ),
    (
        ObjectState::Waiting,
        false,
        "waiting|stopped|stranded|drawn up|pulled up|held up|stalled in traffic|standing idle|standing by|at rest|at a stop|at a halt|stood|brought to a stop|brought to a halt|frozen in place|rooted to the spot|immobile|still|unmoved|engine idling|on standby|in waiting|waiting patiently|patiently waiting|with its engine running|with the engine running|on hold|paused|blocked in|boxed in|trapped|gridlocked in|bogged down|halted there|stock still|dead still|ahalt|lounging|seated|propped|leaning|crouched|squatting|kneeling|huddled|clustered|bunched|bunched together|grouped|grouped together|massed|stacked|piled|piled up|mounted|erected|installed|deployed|scattered|spread|spread out|spaced|spaced out|strung out|strung|dotted|planted|dropped|stood up|drawn|marshalled|aligned|lying around|lying there|left|stationary|standing|standing still|idling|idle|halted|queuing|queueing|queued|stopping|sitting|motionless|halting|lined up|lingering|resting|pausing|waiting to go|stuck|at a standstill|loitering|unmoving|static|\
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
        "moving|driving|travelling|mobile|under way|underway|in transit|on its way|on his way|on her way|on their way|en route|at speed|at full speed|at high speed|at low speed|at a crawl|at walking pace|at walking speed|at a snails pace|in slow motion|bound|outbound|inbound|on the go|in full flight|out for a walk|out for a run|out for a stroll|out walking|out running|out jogging|out for a jog|out cycling|on a walk|on a run|taking a walk|taking a stroll|having a walk|having a stroll|going for a walk|going for a run|going for a jog|pushing a stroller|pushing a buggy|pushing a pushchair|pushing a baby carriage|pushing a shopping trolley|pushing a shopping cart|pushing a wheelchair|walking home|going home|on foot|traveling|cruising|passing|rolling|racing|speeding|running|walking|riding|cycling|jogging|strolling|overtaking|merging|accelerating|braking|reversing|backing up|\
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
        "big|large|hefty|colossal|mighty|jumbo|king size|king sized|outsized|over sized|immense|humongous|mammoth|sizeable|sizable|great big|great|substantial|vast|beefy|heavyweight|monstrous|full length|huge|long|tall|giant|massive|enormous|heavy|bulky|oversized|wide|full size|full sized|extra long|gigantic|heavy duty|stretch|high|bigger|larger",
    ),
    (
        SizeHint::Small,
        "small|wee|teeny|pint sized|pocket sized|compact little|stubby|modest|narrow built|undersized|baby|little|tiny|short|mini|miniature|compact sized|petite|smaller|low",
    ),
];

/// Attributes that are kept in words.
pub const ATTRIBUTES: &str = "facetoface|sidebyside|free standing|freestanding|stand alone|standalone|slow|leisurely|sedately|steadily|briskly|brisk|swiftly|swift|rapidly|rapid|hastily|hasty|unhurried|unhurriedly|lazily|lazy|casually|casual|calmly|patiently|patient|impatiently|impatient|noisy|noisily|silent|silently|smoothly|hesitantly|hesitant|stubborn|stubbornly|sluggish|sluggishly|speedy|speedily|wildly|dangerously|illegally|legally|properly|correctly|badly|barely|hurriedly|happily|happy|sad|sleepy|weary|exhausted|smiling|laughing|shouting|bored|angry|confused|injured|wounded|visually impaired|hard of hearing|tipsy|well dressed|uniformed|barefoot|masked|hooded|bearded|bald|blonde|tall looking|slim|fat|thin|unknown|strange|mysterious|suspicious|brand new|second hand|used|dented|smashed|burnt out|burned out|burning|smoking|broken|crumpled|overturned|upturned|flipped|toppled|knocked over|fallen|flattened|weathered|muddy|mud splattered|dust covered|snow capped|laden|heavily laden|heavily loaded|fully loaded|overloaded|half empty|half loaded|refrigerated|articulated|convertible looking|armoured|armored|diesel|petrol|gas powered|battery powered|hybrid powered|low emission|rented|borrowed|stolen|unlicensed|unmarked|marked|official|municipal|city owned|council|military|army|school|tourist|double axle|two axle|three axle|six wheeled|four wheeled|two wheeled|three wheeled|reflective|flashing|blinking|illuminated|unlit looking|portable|temporary|makeshift|provisional|permanent|massive looking|sturdy|solid|interlocking|linked|numbered|identical|similar|matching|same sized|various sized|aforementioned|said|certain|particular|mere|sole|only visible|lonely|single file|several metre|well lit|poorly lit|badly lit|dimly lit|brightly lit|covered|roofed|tinted|foreign|german|french|italian|american|british|japanese|korean|chinese|swedish|slowly|fast|quickly|slow moving|fast moving|old|new|young|elderly|modern|vintage|classic|luxury|expensive|cheap|rusty|damaged|electric|autonomous|\
    yellow and black|striped|loaded|unloaded|delivery|police|emergency|fire|danger|hazard|private|commercial|public|electric powered|careful|carefully|drunk|distracted|cautious|cautiously|aggressive|aggressively|reckless|recklessly|slower|faster|dark coloured|light coloured|sporty|fancy|dirty|clean|shiny|battered|wrecked|wet looking|open|closed|loud|quietly|gently|nervous|hooded|tired|lost|forgotten|neglected|overlooked|stray|leftover|orphaned|misplaced|discarded|forlorn|careless|orange and white|red and white|concrete|plastic|wooden|metal|full|local|regular|ordinary|normal|typical|standard|plain";
