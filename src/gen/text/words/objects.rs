//! Words for things: object classes with what each word implies. `a|b` are synonyms; plurals follow by rule,
//! irregular ones after a slash.

use crate::scene::Class;
use crate::scene::graph::{ObjectState, SizeHint};

/// What a noun names.
#[derive(Debug, PartialEq)]
pub struct Noun {
    /// Classes it may mean; the first is the one that is placed.
    pub classes: &'static [Class],
    /// Length, width, height, m, where it differs from its class.
    pub size_m: Option<[f64; 3]>,
    /// What the word says of its state.
    pub state: Option<ObjectState>,
    /// What the word says of its size.
    pub size: Option<SizeHint>,
    /// A remark to the reader when the class is only the nearest there is.
    pub nearest: bool,
    /// A collective: how many, if not one.
    pub several: u32,
    /// The words.
    pub words: &'static str,
}

const fn noun(classes: &'static [Class], words: &'static str) -> Noun {
    Noun {
        classes,
        size_m: None,
        state: None,
        size: None,
        nearest: false,
        several: 1,
        words,
    }
}

impl Noun {
    const fn sized(mut self, l: f64, w: f64, h: f64) -> Self {
        self.size_m = Some([l, w, h]);
        self
    }
    const fn state(mut self, state: ObjectState) -> Self {
        self.state = Some(state);
        self
    }
    const fn nearest(mut self) -> Self {
        self.nearest = true;
        self
    }
    const fn several(mut self, n: u32) -> Self {
        self.several = n;
        self
    }
}

use Class::{
    Barrier, Bicycle, Bus, Car, ConstructionVehicle, Motorcycle, Pedestrian, TrafficCone, Trailer, Truck,
};

/// Every vehicle with an engine.
pub const VEHICLES: &[Class] = &[Car, Truck, Bus, Trailer, ConstructionVehicle, Motorcycle];

/// All nouns.
pub const NOUNS: &[Noun] = &[
    noun(
        &[Car],
        "car|auto|automobile|hearse|motor|banger|runabout|family car|family saloon|four door|two door|fastback|muscle car|hot hatch|estate wagon|shooting brake|town car|cop cruiser|sheriffs car|police cruiser car|driving school car|learner car|micro car|smart car|micra|golf|corolla|civic|mustang|ferrari|porsche|lamborghini|bentley|rolls royce|jaguar|skoda|renault|peugeot|hyundai|kia|nissan|mazda|citroen|opel|vauxhall|subaru|lexus|sedan|saloon|saloon car|hatchback|hatch|coupe|convertible|cabriolet|roadster|sports car|\
         sportscar|supercar|limousine|limo|station wagon|wagon|estate car|estate|motorcar|motor car|passenger car|\
         passenger vehicle|compact car|compact|city car|electric car|ev|taxi|taxicab|cab|taxi cab|minicab|uber|\
         police car|patrol car|police cruiser|cop car|squad car|police vehicle|tesla|toyota|bmw|audi|mercedes|ford|volkswagen|\
         vw|honda|volvo|fiat|prius|beetle|mini cooper|hire car|rental car|company car|robotaxi|self driving car|autonomous car|carr|cras",
    ),
    noun(&[Car], "suv|jeep|land rover|range rover|crossover|four by four|off roader|four wheel drive|offroader|sport utility vehicle").sized(4.8, 2.0, 1.85),
    noun(
        &[Car],
        "van|minivan|ambulance van|police van|transit|box van|bread van|milk float|minibus taxi|vw bus|security van|luton|courier van|parcel van|high roof van|people mover|ice cream truck van|mini van|people carrier|mpv|panel van|cargo van|transit van|passenger van|campervan|camper van|camper|\
         delivery van|postal van|mail van|work van|builders van|transporter|sprinter|ambulance",
    )
    .sized(5.4, 2.1, 2.4),
    noun(
        &[Truck],
        "truck|lorry|goods lorry|wagon lorry|curtainsider|hgv lorry|seven and a half tonner|dust cart|bin wagon|waste truck|gritting lorry|gritter lorry|snowplough|snowplough truck|plough|salt truck|salt spreader|car transporter|car carrier|hauler|transport lorry|cattle truck|livestock lorry|refrigerated lorry|reefer truck|skip lorry|cement lorry|concrete lorry|furniture van lorry|supermarket lorry|delivery lorry|army truck|military truck|artics|hook lift truck|vacuum truck|utility truck|heavy goods vehicle|hgv|goods vehicle|semi|semi truck|semitruck|eighteen wheeler|big rig|articulated lorry|artic|\
         delivery truck|box truck|moving truck|removal van|removals van|removal lorry|dump truck|dumper truck|dumper|tipper|tipper truck|\
         tipper lorry|garbage truck|refuse truck|trash truck|bin lorry|dustcart|rubbish truck|recycling truck|garbage lorry|tow truck|\
         breakdown truck|recovery truck|wrecker|flatbed|flatbed truck|tanker|tanker truck|fuel truck|petrol tanker|oil tanker|\
         fire engine|fire truck|firetruck|fire appliance|cement truck|concrete truck|cement mixer|concrete mixer|mixer truck|juggernaut|\
         tractor trailer|truck trailer|motorhome|motor home|rv|recreational vehicle|food truck|ice cream van|cargo truck|freight truck|\
         haulage truck|logging truck|mail truck|ups truck|dhl truck|fedex truck|parcel truck|snow plough|snowplow|snow plow|gritter|\
         street sweeper|road sweeper|transport truck|luton van|wheeler|tonner|milk lorry|coal lorry|removal truck|trucl|lorrie/lorries",
    ),
    noun(&[Truck], "pickup|pick up|pickup truck|pick up truck|ute|bakkie").sized(5.6, 2.1, 1.9),
    noun(
        &[Bus],
        "bus/buses/busses|double deck bus|articulated coach|single decker|single decker bus|rail replacement bus|omnibuses|charabanc|party bus|works bus|hop on hop off bus|sightseeing bus|county bus|coach/coaches|city bus|school bus|double decker|double decker bus|minibus|mini bus|shuttle|shuttle bus|transit bus|\
         tour bus|tourist bus|tourist coach|public bus|public transport bus|omnibus|trolleybus|articulated bus|bendy bus|\
         bendybus|night bus|commuter bus|airport bus|greyhound|airport shuttle|motorcoach|autobus",
    ),
    noun(&[Bus], "tram|streetcar|tramway car|trolley|trolley car|light rail vehicle|tramcar").nearest(),
    noun(
        &[Trailer],
        "trailer|semi trailer|towed trailer|camping trailer|glamping trailer|mobile home|animal trailer|car hauler trailer|generator trailer|trailer tent|boat on a trailer|container trailer|semitrailer|caravan|travel trailer|cargo trailer|flatbed trailer|boat trailer|horse trailer|horsebox|lorry trailer|\
         utility trailer|car trailer|house trailer",
    ),
    noun(
        &[ConstructionVehicle],
        "construction vehicle|excavator|mini digger|mini excavator|backacter|jcb digger|road paver|tarmac machine|tarmac layer|asphalt machine|asphalt roller|road laying machine|piling rig|drilling rig|earth moving machine|dump loader|tower crane|scissor lift|aerial work platform|bucket loader|scraper|harvester|plant machine|building vehicle|digger|mechanical digger|bulldozer|dozer|backhoe|backhoe loader|front loader|front end loader|\
         wheel loader|loader|crane|mobile crane|crane truck|steamroller|steam roller|road roller|roller|compactor|paver|asphalt paver|grader|\
         forklift|fork lift|forklift truck|skid steer|bobcat|jcb|construction machine|construction machinery|building machine|\
         earth mover|earthmover|heavy equipment|construction equipment|construction truck|work machine|work vehicle|cherry picker|tractor|\
         farm tractor|combine harvester|combine|road works vehicle|roadworks vehicle|caterpillar|trencher|telehandler",
    ),
    noun(
        &[Motorcycle],
        "motorcycle|motorbike|scooterist|scooter driver|mopedist|motorcycle courier|motorbike courier|crotch rocket|trike|motor tricycle|motorcycle cop|motorbike cop|police motorcycle|police motorbike|pizza scooter|motor bike|motor cycle|motorcyclist|biker|moped|motor scooter|scooter|vespa|motorcycle rider|motorbike rider|\
         harley|chopper|dirt bike|sports bike|superbike|motorised bike|delivery scooter|two wheeler|motorized bike|scooter rider|moped rider|quad bike|quad",
    ),
    noun(
        &[Bicycle],
        "bicycle|bike|velocipede|push bicycle|penny farthing|racer bike|city bike|hire bike|rental bike|delivery rider on a bike|cargo bicycle|fixie|bmx|recumbent|velomobile|bike messenger|food courier on a bike|cyclist|bicyclist|push bike|pushbike|pedal cycle|cycle|cycle rider|bicycle rider|bike rider|road bike|mountain bike|\
         e bike|ebike|electric bike|electric bicycle|pedal bike|cargo bike|racing bike|tandem|rickshaw|tricycle|bike courier|bicycle courier|\
         cycle courier|person on a bike|person on a bicycle|man on a bike|woman on a bike|man on a bicycle|woman on a bicycle|\
         kid on a bike|child on a bike|child on a bicycle|boy on a bike|girl on a bike|someone on a bike|guy on a bike|somebody on a bike|\
         people on bikes/people on bikes|people on bicycles/people on bicycles|e scooter|electric scooter|kick scooter|bycicle|bycycle|bicicle",
    ),
    noun(
        &[Pedestrian],
        "pedestrian|person/people/persons|human|human being|walker|passer by/passers by|passerby/passersby|bystander|man/men|woman/women|guy|lady|\
         gentleman/gentlemen|male|female|adult|worker|construction worker|road worker|workman/workmen|workmen|builder|labourer|laborer|police officer|\
         policeman/policemen|policewoman/policewomen|cop|officer|traffic warden|traffic officer|crossing guard|lollipop lady|lollipop man|\
         commuter|shopper|tourist|student|teenager|teen|youth|granny|gran|grandad|granddad|nanny|baby|teacher|nurse|doctor|vendor|street vendor|cleaner|gardener|engineer|soldier|protester|demonstrator|spectator|onlooker|visitor|customer|friend|lad|bloke|chap|dude|elder|athlete|football fan|inspector|security guard|waiter|busker|musician|photographer|salesman/salesmen|cameraman/cameramen|grandma|grandmother|grandpa|grandfather|old man/old men|old woman/old women|old lady|\
         elderly person/elderly people|elderly man/elderly men|elderly woman/elderly women|senior|senior citizen|pensioner|mother|father|mum|mom|dad|\
         parent|businessman/businessmen|businesswoman/businesswomen|businessperson|office worker|postman/postmen|mailman/mailmen|mail carrier|\
         delivery man/delivery men|delivery person|courier|dog walker|hiker|stroller|jaywalker|someone|somebody|figure|foot traffic|folk|folks|individual|\
         stranger|firefighter|fireman/firemen|fire fighter|paramedic|surveyor|flagger|hitchhiker|drunk|beggar|local|resident|neighbour|neighbor|\
         driver|rider|dad with a pram|walkers|rambler|pedlar|toddlers|crossing warden|refuse collector|dustman/dustmen|bin man/bin men|binman/binmen|roadworker|lollipop man/lollipop men|labourers|tradesman/tradesmen|businesspeople/businesspeople|policeperson|police officer|constable|patrolman/patrolmen|schoolteacher|couple of people/couple of people|oap|fella|gent|teenage boy|teenage girl|bride|priest|nun|monk|chef|barista|reporter|journalist|evangelist|farmer|carpenter|plumber|electrician|mechanic|foreman/foremen|homeless person|homeless man|drunkard|party goer|partygoer|reveller|clubber|cop on foot|passenger|waiting passenger|pedestrain|pedestian|pedestrianss|ppl",
    ),
    noun(&[Pedestrian], "jogger|runner").state(ObjectState::Moving),
    noun(&[Pedestrian], "child/children|kid|boy|girl|toddler|schoolchild/schoolchildren|schoolkid|schoolboy|schoolgirl|school child/school children|pupil|youngster|little boy|little girl|infant").sized(0.5, 0.5, 1.25),
    noun(&[Pedestrian], "crowd|crowd of people|crowd of pedestrians|mob|throng|crowds of people/crowds of people|crowds/crowds").several(10),
    noun(&[Pedestrian], "family").several(4),
    noun(&[Pedestrian], "wheelchair user|person in a wheelchair|man in a wheelchair|woman in a wheelchair|wheelchair|skateboarder|skater|roller skater|rollerblader|inline skater|segway|segway rider").nearest(),
    noun(&[Pedestrian], "pram|baby carriage|pushchair|buggy|baby stroller|person with a stroller|woman with a stroller|woman with a pram|man with a pram|mother with a pram|\
         mother with a stroller|person with a pram|man with a stroller|parent with a stroller|parent with a pram|mother with a pushchair|shopping trolley|shopping cart").nearest(),
    noun(
        &[TrafficCone],
        "traffic cone|cone|trafic cone|safety bollard cone|road pylon|parking cone|rubber cone|lane marker|pylon|safety cone|road cone|orange cone|construction cone|warning cone|witchs hat|traffic pylon|marker cone|safety pylon|\
         traffic conus|pilon|hazard cone|delineator|channelizer|warning triangle",
    ),
    noun(
        &[Barrier],
        "barrier|jersey barrier|road block barrier|traffic barrier board|steel barrier|metal barrier|wooden barrier|plastic barrier|barricade board|a frame barrier|pedestrian barrier|chapter eight barrier|safety rail|safety fence|cordon|crowd fence|concrete divider|lane divider|concrete blocks/concrete blocks|concrete barrier|road barrier|traffic barrier|construction barrier|barricade|safety barrier|water filled barrier|\
         plastic barrier|crash barrier|k rail|jersey wall|roadblock|road block|concrete block|traffic barricade|crowd barrier|crowd control barrier|\
         temporary barrier|construction fence|temporary fence|blockade|guard rail|guardrail|hurdle|sawhorse|warning board|road closure|boom barrier|\
         construction barricade|barier|barrer|concrete wall|work zone barrier|traffic block|police barrier",
    ),
    noun(&[Barrier], "bollard|post|traffic bollard").sized(0.35, 0.35, 1.0).nearest(),
    noun(VEHICLES, "vehicle|motor vehicle|motorist|other vehicle|road user|emergency vehicle|vehical|vehicule|automotive"),
    noun(&[Car, Truck, Bus, Trailer, ConstructionVehicle, Motorcycle, Bicycle], "traffic|road traffic|vehicular traffic").several(6),
    noun(&[Motorcycle, Bicycle], "two wheelers"),
    noun(&[TrafficCone, Barrier], "obstacle|obstruction|hazard"),
    noun(
        &[Car, Truck, Bus, Trailer, ConstructionVehicle, Motorcycle, Bicycle, Pedestrian, TrafficCone, Barrier],
        "object|thing|everything|item|box/boxes|actor|anything|obstacle of any kind",
    ),
];

/// Road works stand for several things at once: class, and how many.
pub const WORKS: &[(Class, u32)] = &[(TrafficCone, 5), (Barrier, 3), (ConstructionVehicle, 1)];
/// Words for them.
pub const WORKS_WORDS: &str = "roadworks|road works|roadwork|road work|construction site|construction zone|construction work|construction works|\
    construction area|work zone|building site|street works|work site|worksite|construction|works|lane closure|maintenance work|repair work|road repairs|\
    road construction|roadwork zone";

/// What people name that no box can be; the scene's surroundings draw some of it by themselves.
pub const BACKGROUND: &str = "tree|bush/bushes|hedge|forest|wood|grass|park|garden|building|skyscraper|house|shop|store|office|office building|tower|apartment building|\
    apartment block|high rise|factory|warehouse|church|school|hospital|mall|shopping mall|fence|wall|street light|street lamp|streetlight|lamp post|lamppost|\
    traffic light|traffic signal|stoplight|stop light|traffic sign|road sign|street sign|stop sign|sign|signal|billboard|bridge|overpass|flyover|\
    tunnel|petrol station|gas station|station|mountain|hill|river|lake|field|farm|meadow|skyline|vegetation|shrub|plant|flower|bench|trash can|bin|dustbin|\
    fire hydrant|hydrant|mailbox|post box|statue|fountain|pole|telephone pole|cafe|restaurant|bar|hotel|bank|supermarket|palm tree|container|shelter|bus shelter|\
    central reservation|median strip|traffic island|cloud|puddle|lamp|greenery|foliage|terrace|stall|market stall|awning|balcony|advert|poster|headlight|headlamp|taillight|tail light|brake light|neon sign|neon light|umbrella|walking stick|cane|crutch/crutches|hat|cap|coat|jacket|vest|high vis vest|hi vis jacket|helmet|mobile|phone|mobile phone|smartphone|newspaper|map|shovel|spade|rope|sign board|lead|leash|basket|parcel|package|sack|tool|toolbox|torch|flag|banner|flashing light|indicator|hazard light|warning light|siren|window|roof|door|garage|gate|railing|luggage|suitcase|backpack|bag|shopping bag";

/// What people name that has neither a class nor a place in the surroundings, with the reason.
pub const CANNOT: &[(&str, &str)] = &[
    (
        "no class for animals",
        "dog|cat|horse|cow|deer|sheep|bird|pigeon|goat|duck|moose|elk|fox|animal|pig|elephant|kangaroo|squirrel|dragon|unicorn|dinosaur|lion|bear|wolf/wolves|goose/geese|hen|chicken|camel|pet|wild boar",
    ),
    (
        "no class for rail, air and water vehicles",
        "train|locomotive|airplane|aeroplane|plane|helicopter|aircraft|jet|boat|ship|yacht|ferry|submarine|ufo|spaceship|drone|rocket|hot air balloon|tank|subway train|metro train",
    ),
    (
        "no class for loose things",
        "puddle of oil|barrel|sandbag|football|suitcase on the road|mattress|debris|pothole|manhole|manhole cover|speed bump|speed hump|ladder|tyre|tire|cardboard box|plastic bag|pallet|rock|fallen tree|boulder|oil spill|skip|dumpster|snowman/snowmen|robot|toy|chair|sofa|piano|banana",
    ),
];
