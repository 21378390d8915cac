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
        "car|auto|automobile|four wheeler|jalopy|clunker|beater|hybrid|hybrid car|plug in hybrid|hot rod|racing car|race car|stretch limo|stretch limousine|company vehicle|black cab|hackney cab|hackney carriage|cabriolet car|soft top|coupe car|sports saloon|notchback|liftback|subcompact|compact vehicle|executive car|private car|private vehicle|family vehicle|city runabout|e car|electric vehicle|zero emission car|police vehicle|police interceptor|highway patrol car|unmarked police car|patrol vehicle|sheriff car|state trooper car|prowl car|panda car|ride share car|rideshare|lyft|cabs|dacia|lada|chevrolet|chevy|dodge|cadillac|buick|pontiac|chrysler|mercedes benz|suzuki|mitsubishi|seat ibiza|alfa romeo|peugot|trabant|passat|civic|camry|accord|polo|fiesta|focus|astra|clio|wheels|wagen|pkw|personal car|light car|light vehicle|touring car|town car|car driver|car with a driver|motor coupe|hearse|motor|banger|runabout|family car|family saloon|four door|two door|fastback|muscle car|hot hatch|estate wagon|shooting brake|town car|cop cruiser|sheriffs car|police cruiser car|driving school car|learner car|micro car|smart car|micra|golf|corolla|civic|mustang|ferrari|porsche|lamborghini|bentley|rolls royce|jaguar|skoda|renault|peugeot|hyundai|kia|nissan|mazda|citroen|opel|vauxhall|subaru|lexus|sedan|saloon|saloon car|hatchback|hatch|coupe|convertible|cabriolet|roadster|sports car|\
         sportscar|supercar|limousine|limo|station wagon|wagon|estate car|estate|motorcar|motor car|passenger car|\
         passenger vehicle|compact car|compact|city car|electric car|ev|taxi|taxicab|cab|taxi cab|minicab|uber|\
         police car|patrol car|police cruiser|cop car|squad car|police vehicle|tesla|toyota|bmw|audi|mercedes|ford|volkswagen|\
         vw|honda|volvo|fiat|prius|beetle|mini cooper|hire car|rental car|company car|robotaxi|self driving car|autonomous car|carr|cras",
    ),
    noun(&[Car], "suv|jeep|s u v|compact suv|crossover suv|sports utility vehicle|sport ute|four wheel drive car|4 x 4|all terrain car|off road vehicle|offroad vehicle|off road car|4wd|hummer|g wagon|landcruiser|land cruiser|pathfinder|station utility|land rover|range rover|crossover|four by four|off roader|four wheel drive|offroader|sport utility vehicle").sized(4.8, 2.0, 1.85),
    noun(
        &[Car],
        "van|minivan|mini mpv|transporter van|white van|tradesmans van|plumbers van|electricians van|bakery van|laundry van|florists van|parcel delivery van|courier vehicle|delivery vehicle|parcel carrier|dormobile|combi van|combi|kombi|vw camper|camping van|camper bus|rescue van|paramedic van|patrol van|prison van|police transporter|minivan taxi|van taxi|shuttle van|window van|panelled van|light commercial vehicle|lcv|commercial van|ice van|catering van|rental van|hire van|cash in transit van|news van|tv van|broadcast van|sprinter van|ford transit|transit connect|caddy|kangoo|vivaro|ducato|ambulence|ambulance car|emergency ambulance|medical van|rescue vehicle|ambulance van|police van|transit|box van|bread van|milk float|minibus taxi|vw bus|security van|luton|courier van|parcel van|high roof van|people mover|ice cream truck van|mini van|people carrier|mpv|panel van|cargo van|transit van|passenger van|campervan|camper van|camper|\
         delivery van|postal van|mail van|work van|builders van|transporter|sprinter|ambulance",
    )
    .sized(5.4, 2.1, 2.4),
    noun(
        &[Truck],
        "truck|lorry|rigid lorry|rigid truck|box lorry|box van truck|truck and trailer|lorry and trailer|road train|semi tractor|semi tractor trailer|tractor unit|prime mover|18 wheeler|ten wheeler|six wheeler|load carrier|load lorry|loaded lorry|cargo lorry|freight lorry|freighter|freight vehicle|cargo vehicle|haulage lorry|haulage vehicle|container truck|container lorry|container carrier|timber lorry|timber truck|log truck|log lorry|gravel truck|gravel lorry|sand truck|brewery truck|beer truck|milk truck|milk tanker|water tanker|water truck|gas tanker|gasoline tanker|gasoline truck|diesel tanker|fuel tanker|chemical tanker|bulk tanker|tank truck|tank lorry|tanker lorry|fire brigade truck|fire lorry|fire tender|fire brigade vehicle|fire brigade engine|fire rescue truck|ladder truck|hook and ladder|pumper|pumper truck|garbage collector truck|waste lorry|waste collection truck|waste collection vehicle|refuse lorry|refuse collection lorry|refuse collection vehicle|refuse vehicle|refuse wagon|trash lorry|trash collection truck|rubbish lorry|rubbish wagon|bin truck|bin collection lorry|recycling lorry|street cleaning vehicle|street cleaner truck|sweeper|sweeper truck|road sweeper truck|sanding truck|sander truck|salting truck|salt lorry|snow truck|snow removal truck|snow clearing truck|tow lorry|towing truck|tow vehicle|breakdown lorry|breakdown vehicle|recovery lorry|recovery vehicle|rescue truck|wrecker truck|flat bed truck|flatbed lorry|low loader|lowloader|lowboy|platform truck|platform lorry|curtain sider|curtain side lorry|refrigerated truck|refrigerator truck|freezer truck|cold truck|chilled lorry|furniture truck|furniture lorry|relocation truck|moving lorry|house moving truck|removal firm lorry|delivery lorries|supply truck|supply lorry|catering truck|armoured truck|armored truck|armoured lorry|cattle lorry|livestock truck|horse lorry|horse truck|monster truck|lkw|camion|heavy truck|heavy lorry|heavy goods lorry|heavy vehicle|light truck|medium truck|commercial vehicle|commercial truck|commercial lorry|work truck|utility lorry|utility company truck|crew truck|quarry truck|dumping truck|dump lorry|tip truck|tip lorry|tipping lorry|tipping truck|ready mix truck|ready mix lorry|readymix|concrete pump truck|concrete mixer truck|concrete mixer lorry|cement mixer truck|cement mixer lorry|mixer lorry|swap body truck|roll off truck|roller container truck|car transport truck|vehicle transporter|autotransporter|mobile library|winnebago|camper truck|rvs|house on wheels|articulated truck|articulated vehicle|articulated tanker|semis|rig|semi lorry|truk|lory|trailer truck|truck with a trailer body|goods lorry|wagon lorry|curtainsider|hgv lorry|seven and a half tonner|dust cart|bin wagon|waste truck|gritting lorry|gritter lorry|snowplough|snowplough truck|plough|salt truck|salt spreader|car transporter|car carrier|hauler|transport lorry|cattle truck|livestock lorry|refrigerated lorry|reefer truck|skip lorry|cement lorry|concrete lorry|furniture van lorry|supermarket lorry|delivery lorry|army truck|military truck|artics|hook lift truck|vacuum truck|utility truck|heavy goods vehicle|hgv|goods vehicle|semi|semi truck|semitruck|eighteen wheeler|big rig|articulated lorry|artic|\
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
        "bus/buses/busses|bus driver bus|omnibus coach|long distance bus|long distance coach|intercity bus|intercity coach|express bus|express coach|regional bus|country bus|town bus|local bus|local service bus|service bus|scheduled bus|metrobus|metro bus|rapid transit bus|passenger bus|passenger coach|excursion coach|excursion bus|charter bus|charter coach|holiday coach|travel coach|overland bus|team bus|team coach|football coach|staff bus|company bus|hotel shuttle|hotel bus|park and ride bus|electric bus|hybrid bus|hydrogen bus|autonomous bus|autonomous shuttle|midibus|minicoach|mini coach|micro bus|microbus|jitney|dolmus|matatu|open top bus|open topped bus|open top double decker|red double decker|routemaster|decker bus|decker|two decker|sightseeing coach|articulated public bus|low floor bus|schoolbus|school coach|church bus|prison bus|police bus|troop bus|army bus|tour coach|touring coach|autocar bus|busse|autobus|bus of the line|line bus|regular bus|citybus|people carrier bus|double deck bus|articulated coach|single decker|single decker bus|rail replacement bus|omnibuses|charabanc|party bus|works bus|hop on hop off bus|sightseeing bus|county bus|coach/coaches|city bus|school bus|double decker|double decker bus|minibus|mini bus|shuttle|shuttle bus|transit bus|\
         tour bus|tourist bus|tourist coach|public bus|public transport bus|omnibus|trolleybus|articulated bus|bendy bus|\
         bendybus|night bus|commuter bus|airport bus|greyhound|airport shuttle|motorcoach|autobus",
    ),
    noun(&[Bus], "tram|streetcar|tram car|light rail|light rail train|tram train|cable car|tramway car|trolley|trolley car|light rail vehicle|tramcar").nearest(),
    noun(
        &[Trailer],
        "trailer|semi trailer|drawbar trailer|box trailer|flat trailer|flat bed trailer|low loader trailer|tipping trailer|tipper trailer|small trailer|single axle trailer|two axle trailer|towing trailer|pulled trailer|goods trailer|freight trailer|garden trailer|luggage trailer|livestock trailer|cattle trailer|horse box|boat on trailer|motorcycle trailer|bike trailer|farm trailer|hay trailer|hay wagon|grain trailer|tractor trailer wagon|advertising trailer|food trailer|office trailer|site trailer|camper trailer|camping caravan|touring caravan|holiday caravan|teardrop trailer|fifth wheel|fifth wheel trailer|trailor|trailler|dolly trailer|truck trailer bed|trailer unit|jet ski trailer|tank trailer|cargo hauler trailer|construction trailer|towed trailer|camping trailer|glamping trailer|mobile home|animal trailer|car hauler trailer|generator trailer|trailer tent|boat on a trailer|container trailer|semitrailer|caravan|travel trailer|cargo trailer|flatbed trailer|boat trailer|horse trailer|horsebox|lorry trailer|\
         utility trailer|car trailer|house trailer",
    ),
    noun(
        &[ConstructionVehicle],
        "construction vehicle|excavator|tracked excavator|wheeled excavator|crawler excavator|long reach excavator|bagger|power shovel|steam shovel|mechanical shovel|shovel loader|wheeled loader|payloader|loading shovel|pay loader|tracked loader|front shovel|back hoe|back hoe loader|digging machine|excavating machine|earthmoving machine|earth moving equipment|earthmoving equipment|earth moving vehicle|bull dozer|bulldozing machine|crawler tractor|crawler|tracked dozer|angle dozer|steam roller machine|vibratory roller|road roller machine|tandem roller|drum roller|smooth drum roller|compaction roller|asphalt compactor|soil compactor|road grader|motor grader|asphalting machine|asphalt finisher|paving machine|paver machine|road paving machine|blacktop paver|tarmac paver|milling machine|road milling machine|planer|road planer|cold planer|crane vehicle|crane lorry|truck crane|truck mounted crane|building crane|construction crane|crawler crane|telescopic crane|lifting crane|lifting platform|aerial lift|aerial platform|boom lift|bucket truck|cherrypicker|hydraulic platform|access platform|elevated work platform|telescopic handler|fork truck|fork lift truck|lift truck|reach truck|pallet truck|front loading shovel|site vehicle|building site vehicle|construction site vehicle|construction rig|construction tractor|plant vehicle|heavy plant|heavy machine|heavy machinery|heavy construction vehicle|heavy construction machine|piece of heavy machinery/pieces of heavy machinery|piece of construction equipment/pieces of construction equipment|piece of plant/pieces of plant|construction equipment vehicle|work machinery|roadbuilding machine|road building machine|road construction vehicle|road construction machine|road machine|site dumper|mini dumper|minidigger|mini loader|skid loader|skid steer loader|skidsteer|concrete pump|pile driver|drill rig|rock breaker|digger machine|drott|bobcat loader|agricultural tractor|agricultural vehicle|agricultural machine|farm vehicle|farm machine|ploughing tractor|tractor with a plough|mower|ride on mower|snow blower|reaper|backhoe digger|dredger|caterpillar digger|cat digger|kubota|mini digger|mini excavator|backacter|jcb digger|road paver|tarmac machine|tarmac layer|asphalt machine|asphalt roller|road laying machine|piling rig|drilling rig|earth moving machine|dump loader|tower crane|scissor lift|aerial work platform|bucket loader|scraper|harvester|plant machine|building vehicle|digger|mechanical digger|bulldozer|dozer|backhoe|backhoe loader|front loader|front end loader|\
         wheel loader|loader|crane|mobile crane|crane truck|steamroller|steam roller|road roller|roller|compactor|paver|asphalt paver|grader|\
         forklift|fork lift|forklift truck|skid steer|bobcat|jcb|construction machine|construction machinery|building machine|\
         earth mover|earthmover|heavy equipment|construction equipment|construction truck|work machine|work vehicle|cherry picker|tractor|\
         farm tractor|combine harvester|combine|road works vehicle|roadworks vehicle|caterpillar|trencher|telehandler",
    ),
    noun(
        &[Motorcycle],
        "motorcycle|motorbike|motor cyclist|motorbiker|motobike|moto|motorcycler|bike with an engine|powered two wheeler|ptw|motorised two wheeler|motorized two wheeler|touring bike|touring motorcycle|sport bike|sportbike|street bike|cruiser bike|trail bike|trials bike|scrambler|enduro|motocross bike|cafe racer|ducati|kawasaki|yamaha|triumph motorcycle|harley davidson|lambretta|scooter with a rider|motor scooterist|moped with a rider|delivery moped|food delivery scooter|pizza delivery scooter|pizza moped|courier motorcycle|courier motorbike|motorised scooter|motorized scooter|petrol scooter|e moped|electric moped|electric motorcycle|electric motorbike|scooter courier|moped courier|moped driver|motorcycle driver|motorbike driver|motorcycle police officer|motorcycle policeman|police biker|motorcycle officer|motorcycle patrol|person on a motorbike/people on motorbikes|person on a motorcycle/people on motorcycles|person on a scooter/people on scooters|person on a moped/people on mopeds|man on a motorbike|man on a motorcycle|man on a scooter|man on a moped|woman on a motorbike|woman on a motorcycle|woman on a scooter|woman on a moped|someone on a motorbike|someone on a scooter|someone on a moped|guy on a motorbike|sidecar motorcycle|motorcycle with sidecar|motorcycle with a sidecar|motorcycle combination|all terrain vehicle|atv|quadbike|four wheeler quad|three wheeler|tuk tuk|auto rickshaw|minibike|pocket bike|motorcicle|motorcyle|motocycle|mo ped|motoscooter|sooter|scooterist|scooter driver|mopedist|motorcycle courier|motorbike courier|crotch rocket|trike|motor tricycle|motorcycle cop|motorbike cop|police motorcycle|police motorbike|pizza scooter|motor bike|motor cycle|motorcyclist|biker|moped|motor scooter|scooter|vespa|motorcycle rider|motorbike rider|\
         harley|chopper|dirt bike|sports bike|superbike|motorised bike|delivery scooter|two wheeler|motorized bike|scooter rider|moped rider|quad bike|quad",
    ),
    noun(
        &[Bicycle],
        "bicycle|bike|bicylce|bicycler|pedaller|pedaler|pedalist|pedal cyclist|push biker|leisure cyclist|racing cyclist|road cyclist|sports cyclist|cycle commuter|bicycle commuter|cycling commuter|commuter on a bike|commuter on a bicycle|bicycle messenger|cycle messenger|bicycle deliveryman|bicycle delivery rider|cycling courier|food courier on a bicycle|delivery cyclist|delivery rider on a bicycle|delivery bicycle|postman on a bike|postman on a bicycle|student on a bike|student on a bicycle|pensioner on a bike|schoolboy on a bike|schoolgirl on a bike|rider on a bicycle|rider on a bike|lady on a bicycle|lady on a bike|gentleman on a bicycle|girl on a bicycle|boy on a bicycle|kid on a bicycle|teenager on a bike|teenager on a bicycle|youth on a bike|someone on a bicycle|somebody on a bicycle|folks on bikes/folks on bikes|men on bikes/men on bikes|women on bikes/women on bikes|kids on bikes/kids on bikes|children on bikes/children on bikes|children on bicycles/children on bicycles|kids on bicycles/kids on bicycles|pedal bicycle|pedal driven bike|pedal powered bike|pedelec|e bicycle|electrically assisted bike|folding bike|folding bicycle|dutch bike|ladies bike|mens bike|childrens bike|kids bike|touring bicycle|touring bicyclist|racing bicycle|road bicycle|mountain biker|mtb|gravel bike|fatbike|fat bike|bmx bike|bmx rider|unicycle|unicyclist|tandem bicycle|tandem bike|three wheeled bike|cargo trike|cargo tricycle|transport bike|long john|bakfiets|pedicab|cycle rickshaw|bicycle rickshaw|handcycle|hand cycle|handbike|rental bicycle|hire bicycle|share bike|bike share bike|shared bike|two wheeled pedal vehicle|e scooter rider|e scooterist|electric scooter rider|kick scooter rider|kick bike|push scooter|bycyclist|cylcist|cyclists on bikes/cyclists on bikes|ciclist|biciclist|cycler|velocipede|push bicycle|penny farthing|racer bike|city bike|hire bike|rental bike|delivery rider on a bike|cargo bicycle|fixie|bmx|recumbent|velomobile|bike messenger|food courier on a bike|cyclist|bicyclist|push bike|pushbike|pedal cycle|cycle|cycle rider|bicycle rider|bike rider|road bike|mountain bike|\
         e bike|ebike|electric bike|electric bicycle|pedal bike|cargo bike|racing bike|tandem|rickshaw|tricycle|bike courier|bicycle courier|\
         cycle courier|person on a bike|person on a bicycle|man on a bike|woman on a bike|man on a bicycle|woman on a bicycle|\
         kid on a bike|child on a bike|child on a bicycle|boy on a bike|girl on a bike|someone on a bike|guy on a bike|somebody on a bike|\
         people on bikes/people on bikes|people on bicycles/people on bicycles|e scooter|electric scooter|kick scooter|bycicle|bycycle|bicicle",
    ),
    noun(
        &[Pedestrian],
        "pedestrian|person/people/persons|someone on foot/people on foot|person on foot/people on foot|man on foot/men on foot|woman on foot/women on foot|foot passenger|foot traveller|footgoer|member of the public/members of the public|walking person/walking people|soul|living soul|mortal|citizen|civilian|townsperson/townspeople|villager|inhabitant|dweller|urbanite|city dweller|ped|fellow|geezer|mate|lass/lasses|gal|dame|madam|bachelor|spinster|grownup|grown up|grown man/grown men|grown woman/grown women|young man/young men|young woman/young women|young lady|young person/young people|young adult|middle aged man/middle aged men|middle aged woman/middle aged women|adolescent|juvenile|scholar|undergraduate|university student|college student|high schooler|retiree|oldster|old person/old people|old folk|old gentleman/old gentlemen|elderly lady|elderly gentleman/elderly gentlemen|elderly couple member|grandparent|great grandmother|auntie|aunt|uncle|cousin|niece|nephew|brother|sister|husband|wife/wives|spouse|girlfriend|boyfriend|daughter|son|housewife/housewives|bridegroom|newlywed|twins child|roadman/roadmen|road crew member|crew member|crewman/crewmen|team member|road mender|roadworks worker|road construction worker|site worker|building worker|building labourer|bricklayer|digger driver on foot|navvy|navvies|hard hat|hard hat worker|welder|painter|roofer|technician|maintenance worker|maintenance man/maintenance men|repairman/repairmen|repair worker|utility worker|municipal worker|city worker|council worker|public worker|sanitation worker|garbage collector|garbage man/garbage men|garbageman/garbagemen|street cleaner|street sweeper with a broom|road sweeper with a broom|sweeper with a broom|employee|staff member|clerk|manager|executive|banker|lawyer|judge|politician|scientist|academic|professor|lecturer|librarian|pharmacist|dentist|midwife/midwives|carer|caregiver|physician|surgeon|medic|first aider|rescuer|rescue worker|ambulanceman/ambulancemen|emergency worker|police constable|policewoman on foot|traffic policeman/traffic policemen|traffic cop|traffic police officer|traffic controller|traffic marshal|marshal|steward|sheriff|deputy|trooper|ranger|guard|watchman/watchmen|doorman/doormen|bouncer|parking attendant|attendant|meter maid|ticket inspector|conductor|flag man/flag men|flagman/flagmen|flag person/flag people|flagperson|signaller|road guard|school patrol|school crossing patrol|crossing patrol|crossing attendant|crossing guard lady|lollipop person|mail lady|postie|postwoman/postwomen|letter carrier|delivery driver on foot|deliverer|deliveryman/deliverymen|delivery guy|delivery boy|delivery woman|pizza delivery guy|newspaper boy|paper boy|newsboy|hawker|peddler|seller|market trader|trader|merchant|shopkeeper|stallholder|shop assistant|salesperson/salespeople|saleswoman/saleswomen|buyer|window shopper|consumer|client|patron|diner|drinker|smoker|guest|invitee|delegate|attendee|concert goer|concertgoer|churchgoer|theatregoer|moviegoer|holidaymaker|holiday maker|vacationer|sightseer|backpacker|traveller|traveler|wayfarer|wanderer|explorer|pilgrim|trekker|nordic walker|power walker|speed walker|sportsman/sportsmen|sportswoman/sportswomen|footballer|player|fan|supporter|race walker|marcher|striker|picket|activist|campaigner|leafleter|canvasser|street performer|performer|dancer|singer|actor|artist|mime|clown|juggler|magician|celebrity|vip|witness|watcher|observer|viewer on foot|gawker|rubbernecker|eyewitness|idler|loiterer|loafer|lingerer|tramp|vagrant|panhandler|drifter|rough sleeper|homeless woman|refugee|migrant|immigrant|foreigner|pickpocket|thief/thieves|robber|suspect|fugitive|blind person|blind man|blind woman|disabled person/disabled people|person with a cane|person on crutches|man on crutches|woman on crutches|dogwalker|person with a dog|man with a dog|woman with a dog|lady with a dog|pet owner|dog owner|person walking a dog|mother of two|mother to be|expectant mother|pregnant woman/pregnant women|new mother|single mother|working mother|babysitter|child minder|childminder|au pair|caretaker|concierge|janitor|gardner|landscaper|arborist|tree surgeon|tree feller|hunter|fisherman/fishermen|angler|sailor|pilot|stewardess|military man|marine|recruit|cadet|scout|girl guide|choirboy|altar boy|bishop|rabbi|imam|vicar|pastor|missionary|beachgoer|swimmer|surfer|cowboy|peasant|shepherd|butcher|baker|grocer|tailor|barber|hairdresser|beautician|seamstress|cook|waitress|barman/barmen|barmaid|bartender|barkeeper|innkeeper|host on foot|receptionist|secretary|assistant|accountant|analyst|developer|programmer|architect|draughtsman/draughtsmen|contractor|supervisor|overseer|boss|director|owner|tenant|landlord|landlady|homeowner|neighbour woman|walker with a dog|person in a coat|person with an umbrella|man with an umbrella|woman with an umbrella|figure in the dark|silhouette|pedestrians group member|persons on foot|foot soldier|perambulator|peeps|pedestrien|pedastrian|peaple|poeple|persone|human|human being|walker|passer by/passers by|passerby/passersby|bystander|man/men|woman/women|guy|lady|\
         gentleman/gentlemen|male|female|adult|worker|construction worker|road worker|workman/workmen|workmen|builder|labourer|laborer|police officer|\
         policeman/policemen|policewoman/policewomen|cop|officer|traffic warden|traffic officer|crossing guard|lollipop lady|lollipop man|\
         commuter|shopper|tourist|student|teenager|teen|youth|granny|gran|grandad|granddad|nanny|baby|teacher|nurse|doctor|vendor|street vendor|cleaner|gardener|engineer|soldier|protester|demonstrator|spectator|onlooker|visitor|customer|friend|lad|bloke|chap|dude|elder|athlete|football fan|inspector|security guard|waiter|busker|musician|photographer|salesman/salesmen|cameraman/cameramen|grandma|grandmother|grandpa|grandfather|old man/old men|old woman/old women|old lady|\
         elderly person/elderly people|elderly man/elderly men|elderly woman/elderly women|senior|senior citizen|pensioner|mother|father|mum|mom|dad|\
         parent|businessman/businessmen|businesswoman/businesswomen|businessperson|office worker|postman/postmen|mailman/mailmen|mail carrier|\
         delivery man/delivery men|delivery person|courier|dog walker|hiker|stroller|jaywalker|someone|somebody|figure|foot traffic|folk|folks|individual|\
         stranger|firefighter|fireman/firemen|fire fighter|paramedic|surveyor|flagger|hitchhiker|drunk|beggar|local|resident|neighbour|neighbor|\
         driver|rider|dad with a pram|walkers|rambler|pedlar|toddlers|crossing warden|refuse collector|dustman/dustmen|bin man/bin men|binman/binmen|roadworker|lollipop man/lollipop men|labourers|tradesman/tradesmen|businesspeople/businesspeople|policeperson|police officer|constable|patrolman/patrolmen|schoolteacher|couple of people/couple of people|oap|fella|gent|teenage boy|teenage girl|bride|priest|nun|monk|chef|barista|reporter|journalist|evangelist|farmer|carpenter|plumber|electrician|mechanic|foreman/foremen|homeless person|homeless man|drunkard|party goer|partygoer|reveller|clubber|cop on foot|passenger|waiting passenger|pedestrain|pedestian|pedestrianss|ppl",
    ),
    noun(&[Pedestrian], "jogger|runner|sprinter|marathon runner|long distance runner|fitness runner|trail runner|fun runner").state(ObjectState::Moving),
    noun(&[Pedestrian], "child/children|kid|schoolkids|small child/small children|young child/young children|little child/little children|little kid|small boy|small girl|young boy|young girl|nipper|tot|tiny tot|toddler boy|kiddo|kiddie|preschooler|kindergartner|nursery child/nursery children|bairn|brat|minor|tween|preteen|first grader|school pupil|primary school child/primary school children|elementary school child|schoolmate|playing child/playing children|school boy|school girl|school kid|boy|girl|toddler|schoolchild/schoolchildren|schoolkid|schoolboy|schoolgirl|school child/school children|pupil|youngster|little boy|little girl|infant").sized(0.5, 0.5, 1.25),
    noun(&[Pedestrian], "crowd|crowd of people|crowd of pedestrians|mob|throng|crowds of people/crowds of people|crowds/crowds").several(10),
    noun(&[Pedestrian], "family").several(4),
    noun(&[Pedestrian], "wheelchair user|wheel chair user|wheelchair rider|person in wheelchair|old man in a wheelchair|lady in a wheelchair|disabled man in a wheelchair|mobility scooter|mobility scooter user|mobility scooter rider|skate boarder|longboarder|hoverboarder|rollerskater|roller blader|in line skater|man on a skateboard|boy on a skateboard|kid on a skateboard|person on a skateboard|girl on roller skates|walker frame|rollator|person with a rollator|woman with a rollator|zimmer frame|person in a wheelchair|man in a wheelchair|woman in a wheelchair|wheelchair|skateboarder|skater|roller skater|rollerblader|inline skater|segway|segway rider").nearest(),
    noun(&[Pedestrian], "pram|pramette|stroller pusher|push chair|person pushing a pram|woman pushing a pram|man pushing a pram|mother pushing a pram|father pushing a pram|person pushing a stroller|woman pushing a stroller|man pushing a stroller|mother pushing a stroller|father pushing a stroller|dad pushing a stroller|mum pushing a pram|mom pushing a stroller|woman pushing a buggy|mother pushing a buggy|father with a pram|father with a stroller|mum with a pram|mom with a stroller|dad with a stroller|woman with a buggy|woman with a pushchair|nanny with a pram|couple with a pram|baby carriage|pushchair|buggy|baby stroller|person with a stroller|woman with a stroller|woman with a pram|man with a pram|mother with a pram|\
         mother with a stroller|person with a pram|man with a stroller|parent with a stroller|parent with a pram|mother with a pushchair|shopping trolley|shopping cart").nearest(),
    noun(
        &[TrafficCone],
        "traffic cone|cone|traffic safety cone|highway cone|motorway cone|street cone|roadwork cone|roadworks cone|road works cone|work zone cone|plastic cone|reflective cone|striped cone|orange and white cone|red and white cone|marking cone|marker pylon|orange pylon|warning pylon|warning pilon|road pilon|traffic pilon|pylon cone|channelizing cone|channelising cone|safety marker|traffic marker|orange marker|cone marker|guide cone|police cone|witches hat|witch hat|hazard marker|hazard triangle|emergency triangle|reflective triangle|safety triangle|beacon|warning beacon|delineator post|lane delineator|tubular marker|lane cone|traffic hat|leitkegel|traffic kone|trafic cones|coen|trafic cone|safety bollard cone|road pylon|parking cone|rubber cone|lane marker|pylon|safety cone|road cone|orange cone|construction cone|warning cone|witchs hat|traffic pylon|marker cone|safety pylon|\
         traffic conus|pilon|hazard cone|delineator|channelizer|warning triangle",
    ),
    noun(
        &[Barrier],
        "barrier|jersey barrier|road barricade|street barrier|street barricade|road fence|road closure barrier|road closed barrier|road closed sign barrier|closure barrier|closing barrier|blocking barrier|striped barrier|red and white barrier|orange barrier|steel fence|metal fence panel|fence panel|mesh fence|mesh barrier|wire fence|site fence|construction hoarding|hoarding|hoarding panel|heras fence|heras panel|safety panel|barrier board|barrier panel|barrier segment|barrier element|barrier fence|fence barrier|fencing|fence element|guard fence|guard barrier|protective barrier|protection barrier|protective fence|protective wall|separating barrier|separation barrier|divider|traffic divider|road divider|median barrier|central barrier|concrete slab|concrete jersey|concrete k rail|concrete element|concrete barricade|jersey block|jersey kerb|new jersey barrier|stone block|stone barrier|water barrier|water filled block|water filled wall|safety wall|temporary wall|temporary barricade|portable barrier|portable barricade|portable fence|mobile barrier|mobile fence|movable barrier|plastic barricade|plastic fence|wooden barricade|trestle|road trestle|saw horse|police barricade|police fence|police cordon|police line|control barrier|crowd control fence|event barrier|event fence|queue barrier|vehicle barrier|car barrier|traffic gate|toll barrier|turnpike gate|level crossing barrier|lifting barrier|blocker|road blocker|street blocker|blocking element|obstacle board|chevron board|chevron barrier|arrow board|type iii barricade|guardrail section|crash rail|armco|armco barrier|crash cushion|impact attenuator|safety railing|handrail|railings barrier|checkpoint barrier|hindrance|barrir|barrior|barriar|bariers|road block barrier|traffic barrier board|steel barrier|metal barrier|wooden barrier|plastic barrier|barricade board|a frame barrier|pedestrian barrier|chapter eight barrier|safety rail|safety fence|cordon|crowd fence|concrete divider|lane divider|concrete blocks/concrete blocks|concrete barrier|road barrier|traffic barrier|construction barrier|barricade|safety barrier|water filled barrier|\
         plastic barrier|crash barrier|k rail|jersey wall|roadblock|road block|concrete block|traffic barricade|crowd barrier|crowd control barrier|\
         temporary barrier|construction fence|temporary fence|blockade|guard rail|guardrail|hurdle|sawhorse|warning board|road closure|boom barrier|\
         construction barricade|barier|barrer|concrete wall|work zone barrier|traffic block|police barrier",
    ),
    noun(&[Barrier], "bollard|steel bollard|concrete bollard|plastic bollard|flexible bollard|retractable bollard|illuminated bollard|safety bollard|warning bollard|stanchion|marker post|delimiter post|post|traffic bollard").sized(0.35, 0.35, 1.0).nearest(),
    noun(VEHICLES, "vehicle|motorized vehicle|motorised vehicle|motor traffic|passenger transport vehicle|means of transport|conveyance|automotive vehicle|moving vehicle|motor vehicle|motorist|other vehicle|road user|emergency vehicle|vehical|vehicule|automotive"),
    noun(&[Car, Truck, Bus, Trailer, ConstructionVehicle, Motorcycle, Bicycle], "traffic|road traffic|motor vehicle traffic|car traffic|through traffic|passing traffic|cross traffic|vehicular traffic").several(6),
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
pub const WORKS_WORDS: &str = "roadworks|road works|roadworks site|roadwork site|road works site|road construction site|construction works site|building works|building work|street construction|street repairs|street repair|street work|roadside works|roadside construction|road repair|road repair works|road maintenance|road maintenance works|maintenance works|maintenance site|repair site|repair works|repair zone|resurfacing|resurfacing work|resurfacing works|paving works|paving work|excavation work|excavation works|excavation site|excavations|utility works|utility work|digging works|civil works|sewer works|pipe works|works zone|works area|working zone|working area|work area|workzone|baustelle|roadwork|road work|construction site|construction zone|construction work|construction works|\
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
