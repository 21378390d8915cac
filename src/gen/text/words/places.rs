//! Words for places, relations, edits, and the small words between them.

use super::super::description::{Anchor, Road};
use crate::scene::graph::LaneRole as L;
use crate::scene::graph::RelationKind as R;

/// Sides as said before or after a noun.
pub const LEFT: &str = "left|left hand|lefthand";
/// The other one.
pub const RIGHT: &str = "right|right hand|righthand";

/// Strips that have sides: anchor without side, left, right, words.
pub const SIDED: &[(L, L, L, &str)] = &[
    (
        L::Roadside,
        L::LeftRoadside,
        L::RightRoadside,
        "roadside|kerb|curb|kerb line|curb line|kerbstone|curbstone|kerb edge|curb edge|roads shoulder|road shoulder|paved shoulder|soft shoulder|grass verge|grass strip|grassy verge|edge|edge of the lane|margin of the road|road margin|wayside|hard strip|rest area bay|turnout|passing place|parking row|parked lane|parking slot|parking box|parking stall|parking niche|parking strips|loading zone|loading area|drop off zone|taxi stand|taxi bay|cab rank|coach bay|coach stop|tram stop|busstop|bus halt|bus stand|stopping bay|emergency bay|emergency strip|emergency shoulder|breakdown bay|bikeway|bicycle path|bicycle track|cycle track|cycleway|bike track|cycle strip|drain|roads gutter|ditch|ditch side|tree line|line of trees|border of the road|border of the street|boundary of the road|flank of the road|outside edge of the road|outer edge of the road|fringe of the road|rim of the road|road boundary|kerbside|curbside|shoulder|hard shoulder|verge|parking lane|parking strip|parking bay|parking bays|edge of the road|road edge|kerb side|edge of the street|\
         roads edge|lay by|layby|side of road|parking spot|parking space|parking spaces|parking place|road side|bus stop|bus bay|gutter|bike lane|cycle lane|bicycle lane|cycle path|bike path|edge of the carriageway|loading bay|breakdown lane|emergency lane|street edge|taxi rank|bus lane",
    ),
    (
        L::Sidewalk,
        L::LeftSidewalk,
        L::RightSidewalk,
        "sidewalk|pavement|footpath|paved path|paved walkway|side path|sidepath|pedestrian way|pedestrian pavement|pedestrian strip|pedestrian zone|footpaths|footway pavement|promenade|boardwalk|pedestrian footpath|walking path|path for pedestrians|trottoir|walk way|walking area|banquette|causeway path|sidwalk|sidewlk|pavment|pavemant|footway|walkway|side walk|pedestrian path|foot path|pedestrian walkway|pedestrian area|footpavement",
    ),
];

/// Places without sides.
pub const PLACES: &[(Anchor, Option<Road>, &str)] = &[
    (
        Anchor::Lane(L::Ego),
        None,
        "middle lane|centre lane|center lane|its lane|its own lane|his lane|his own lane|their lane|their own lane|its driving lane|egos own driving lane|my lane|our lane|my own side of the road|my driving lane ahead|lane i drive in|lane i am driving in|lane im driving in|lane that i drive in|lane that im in|lane that i am in|lane we drive in|lane we are driving in|lane were driving in|lane that we are in|lane i travel in|lane i use|lane i am using|lane im using|lane im on|lane i am on|lane were on|lane we are on|lane of mine|lane of ours|my traffic lane|our traffic lane|my travel lane|our travel lane|travel lane|ego vehicle lane|egos path|egos driving lane|egos own lane|the egos lane|lane of travel|my lane of travel|our lane of travel|my track|our track|my direct path|my trajectory|our trajectory|my route|our route|my line of travel|path ahead|my path ahead|our path ahead|the path ahead|road ahead lane|very same lane|identical lane|lane of the test vehicle|lane of the host vehicle|host vehicle lane|drivers lane|lane where i am|lane where we are|lane i occupy|lane we occupy|my half of the road|our half of the road|my carriageway|our carriageway|my line|our line|ego lane|egos lane|the ego lane|own lane|my own lane|our own lane|current lane|ego vehicles lane|lane im in|lane i am in|lane were in|lane we are in|lane of the ego|\
         lane of the ego vehicle|host lane|my path|our path|my way|our way|my side of the road|our side of the road|lane|same lane|driving lane|the same lane as me|same lane as me|same lane as us|lane ahead|lane in front of me|my driving lane|path of the ego vehicle|path of the ego|ego path|lane of my car|traffic lane|my side|our side|my lane ahead|our lane ahead",
    ),
    (
        Anchor::Lane(L::Left),
        None,
        "left lane|left hand lane|lane immediately to my left|lane immediately to the left|lane directly to my left|lane directly to the left|lane next to me on the left|lane beside me on the left|lane on the left hand side|lane on the left side|lane at the left|lane at my left|lane leftwards|adjacent lane on the left|adjacent lane to the left|adjacent lane to my left|neighbouring lane on the left|neighbouring lane to the left|neighboring lane on the left|neighboring lane to the left|neighboring left lane|left neighbouring lane|left neighboring lane|left adjacent lane|left most lane|left travel lane|left traffic lane|lane further left|lane one to the left|one lane to the left|one lane to my left|one lane left|one lane over to the left|one lane over on the left|next lane on the left|next lane on my left|next lane to my left|next left lane|offside lane|quick lane|overtake lane|lane left|lane to our immediate left|second lane from the right|lane left of us|lane left of ours|lane left of the ego|lane to my left|lane to our left|lane on the left|lane to the left|lane on my left|lane on our left|next lane to the left|passing lane|fast lane|overtaking lane|lane left of me|\
         lane left of mine|left driving lane|leftmost lane|adjacent left lane|lane to the left of me|lane to the left of mine|far left lane|inside lane|inner lane|neighbouring left lane",
    ),
    (
        Anchor::Lane(L::Right),
        None,
        "right lane|right hand lane|lane immediately to my right|lane immediately to the right|lane directly to my right|lane directly to the right|lane next to me on the right|lane beside me on the right|lane on the right hand side|lane on the right side|lane at the right|lane at my right|adjacent lane on the right|adjacent lane to the right|adjacent lane to my right|neighbouring lane on the right|neighbouring lane to the right|neighboring lane on the right|neighboring lane to the right|neighboring right lane|right neighbouring lane|right neighboring lane|right adjacent lane|right most lane|right travel lane|right traffic lane|lane further right|lane one to the right|one lane to the right|one lane to my right|one lane right|one lane over to the right|one lane over on the right|next lane on the right|next lane on my right|next lane to my right|next right lane|nearside lane|kerb lane|curb lane|kerbside lane|curbside lane|crawler lane|crawling lane|turn right lane|right turn lane|right turning lane|lane right|lane right of us|lane right of ours|lane right of the ego|far right hand lane|lane to my right|lane to our right|lane on the right|lane to the right|lane on my right|lane on our right|next lane to the right|slow lane|lane right of me|lane right of mine|\
         rightmost lane|adjacent right lane|lane to the right of me|lane to the right of mine|far right lane|outside lane|outer lane|neighbouring right lane",
    ),
    (
        Anchor::Lane(L::Oncoming),
        None,
        "oncoming lane|other lane|the other lane|oncoming lanes|other side of the centre line|other side of the center line|other side of the median|far carriageway|opposite side of the carriageway|opposite roadway|opposing carriageway|opposing roadway|opposing side|counter lane|contra lane|opposite direction lane|lane of the oncoming traffic|lane of opposing traffic|lane of the opposing traffic|lane for opposing traffic|lane for the oncoming traffic|lane for traffic coming the other way|lane of the opposite direction|lane for the opposite direction|lane for the other direction|lane of the other direction|other direction lane|lane in the opposing direction|lane for the opposing direction|opposite driving lane|opposing driving lane|opposite traffic lane|opposite travel lane|opposing travel lane|oncoming driving lane|oncoming travel lane|oncoming traffics lane|oncoming roadway|oncoming side of the road|lane across the centre line|lane across from me|lane opposite|other sides lane|reverse lane|against the traffic lane|lane that leads the other way|lane going the other way|lane running the other way|lane heading the other way|lane that comes towards me|lane coming towards me|lane that comes the other way|left hand carriageway|opposite half of the road|other half of the road|opposite lane|opposing lane|oncoming traffic lane|wrong side of the road|opposite carriageway|other carriageway|oncoming side|contraflow lane|opposite lanes|opposing lanes|\
         lane for oncoming traffic|lane of oncoming traffic|lane in the opposite direction|lane in the other direction|opposing traffic lane|oncoming carriageway|lane coming the other way|wrong lane|wrong side",
    ),
    (
        Anchor::Lane(L::Cross),
        None,
        "cross street|side street|sidestreet|sideroad|side turning|side lane|intersecting lane|transverse road|transverse street|crossing lane|joining road|branch road|branching road|street on the side|road that crosses mine|road crossing mine|street crossing mine|road crossing ours|intersecting highway|side road|crossing road|crossing street|intersecting road|intersecting street|cross road|cross traffic lane|adjoining road|side streets|perpendicular road|perpendicular street",
    ),
    (
        Anchor::Lane(L::Road),
        None,
        "road|street|roadway|driving surface|road surface|blacktop|paved road|pavement surface|lane markings|the open road|the roadway itself|driveway surface|traffic lanes|travelled way|highway surface|thoroughfare itself|width of the road|full width of the road|entire width of the road|whole width of the road|entire street|whole street|full street|entire carriageway|whole carriageway|entire roadway|middle of the carriageway|centre of the carriageway|middle of the roadway|very middle of the road|dead centre of the road|midst of the road|middle of the lanes|every lane|carriageway|lanes|tarmac|asphalt|middle of the road|middle of the street|centre of the road|center of the road|center of the street|centre of the street|driveable area|drivable area|travel lanes|lanes of traffic|entire road|whole road|all lanes|both lanes|way",
    ),
    (
        Anchor::Lane(L::Carpark),
        Some(Road::Parking),
        "car park|carpark|parking lot|parkinglot|parking place area|parking yard|parking facility|parking field|parking zone|parking court|multi storey|multi storey car park|multistorey|park and ride|customer car park|customer parking|visitor parking|visitors car park|supermarket parking|mall parking|mall parking lot|shop car park|store parking lot|hotel car park|station car park|office car park|staff car park|public car park|public parking lot|paid parking lot|open air car park|forecourt|parking structure|parkade|parking area|parking garage|parking|parking deck|parking ground|lot|car parks|supermarket car park|supermarket parking lot",
    ),
    (
        Anchor::Crossing,
        None,
        "crosswalk|pedestrian lights|pedestrian light|pedestrian signal|pedestrian signals|ped lights|stripes|white stripes|zebra crossing|zebra crosswalk|zebra crossings stripes|zebra markings|striped crossing|white stripes|striped crosswalk|marked crossing|marked crosswalk|painted crossing|crossing point|crossing place|crossing area|toucan crossing|crossing for pedestrians|pedestrian zebra|pedestrian cross walk|ped xing|pedestrian xing|xing|foot crosswalk|footpath crossing|signalised crossing|signalized crossing|light controlled crossing|pedestrian passage|pedestrian lights crossing|zebras|zebra strip|zebra striped crossing|crossing stripes|crosswalk stripes|pedestrian stripes|crosswlk|crossswalk|zebracrossing|walkover|pedestrian crossing|zebra|pelican crossing|cross walk|zebra stripes|crossing|ped crossing|foot crossing|puffin crossing|pedestrian crosswalk|zebra cross|school crossing|croswalk",
    ),
    (
        Anchor::Junction,
        Some(Road::Intersection),
        "junction|intersection|crossroads|street crossing|street intersection|road intersection|four way|fourway|fourway intersection|four way crossroad|four armed junction|four arm junction|four leg intersection|four legged intersection|cross roads|crossways|cross junction|crossing of two roads|crossing of two streets|meeting of two roads|interchange|traffic light junction|traffic light intersection|light controlled junction|light controlled intersection|traffic light controlled junction|set of lights|set of traffic lights|stop lights|stop signal|signal lights|amber light|green light|green traffic light|red signal|stoplights|light signal|give way line|give way sign|yield sign|yield line|stop marking|halt line|holding line|box junction|yellow box|uncontrolled intersection|intersection ahead|corner of the street|corner of the road|intersecion|intersektion|crosroads|junktion|crossroad|four way intersection|4 way intersection|four way junction|four way stop|4 way stop|road junction|street corner|corner|4 way junction|four way crossing|road crossing|\
        signalised intersection|signalized intersection|signalised junction|traffic lights|traffic light|red light|lights|stop line|stop sign|traffic signal|traffic signals|red lights|stop light|stoplight|red traffic light|junctoin|intersecton|four way crossroads|x junction",
    ),
    (
        Anchor::Junction,
        Some(Road::TJunction),
        "t junction|t intersection|t junctions|tjunction|three armed junction|three arm junction|three leg intersection|three legged intersection|three way crossing|junction shaped like a t|t shaped intersection|t crossroads|teejunction|dead end junction|road that ends in a t|y intersection|y shaped junction|three way intersection|three way junction|tee junction|3 way intersection|t crossing|3 way junction|three way stop|y junction|fork|fork in the road|t shaped junction|t section",
    ),
    (
        Anchor::Junction,
        Some(Road::Roundabout),
        "roundabout|traffic circle|traffic roundabout|roundabouts island|circular junction|circular intersection|rond point|circus|traffic island roundabout|rotary intersection|traffic rotary|rounabout|roundabuot|rotary|gyratory|round about|circle|island roundabout|mini roundabout",
    ),
];

/// Relations that need a place or an object after them.
pub const RELATIONS: &[(R, &str)] = &[
    (
        R::InFrontOf,
        "in front of|ahead of|at the head of|at the front of|to the front of|on the front side of|up in front of|out in front of|forward of|off the front of|off the bow of|facing the back of|on this side of|this side of|short of|at the near side of|on the near side of|prior to|in advance of|preceding|farther ahead of|further ahead of|farther along than|further along than|further on than|further up than|further up the road than|further down the road than|infront of|in the front of|right in front of|just in front of|directly in front of|immediately in front of|directly ahead of|before|just ahead of|straight ahead of|downstream of|right ahead of|shortly before|leading|leads|up ahead of",
    ),
    (
        R::Behind,
        "behind|in back of|at the tail of|on the tail of|in the wake of|in the slipstream of|at the back end of|at the far side of|on the far side of|on the back side of|rearward of|to the back of|back of|tucked in behind|in rear of|on the bumper of|at the bumper of|further back than|farther back than|back from|aft of|down the road from|at the back of|at the rear of|to the rear of|right behind|just behind|directly behind|immediately behind|straight behind|in the rear of|after|past|beyond|upstream of|hidden behind|half hidden behind|partially hidden behind|occluded by|hidden by|obscured by|concealed by|masked by|screened by|covered by|partly hidden by|partially hidden by|half hidden by|partially obscured by|partially occluded by|shadowed by|hiding behind|sheltering behind|shielded by|close behind",
    ),
    (
        R::LeftOf,
        "left from|to the left from|left hand of|left of|to the left of|on the left of|to the left hand side of|on the left side of|on the left hand side of|at the left of|left side of|to the left side of|left hand side of|on left of|on left side of|at the left side of|on the lefthand side of|just left of|directly left of|immediately left of|immediately to the left of|directly to the left of|just to the left of|along the left side of|at the left hand side of|along the left of|down the left side of",
    ),
    (
        R::RightOf,
        "right from|to the right from|right hand of|right of|to the right of|on the right of|to the right hand side of|on the right side of|on the right hand side of|at the right of|right side of|to the right side of|right hand side of|on right of|on right side of|at the right side of|on the righthand side of|just right of|directly right of|immediately right of|immediately to the right of|directly to the right of|just to the right of|along the right side of|at the right hand side of|along the right of|down the right side of",
    ),
    (
        R::Near,
        "near|near to|around by|nigh|near by|in the neighbourhood of|in the neighborhood of|within sight of|within metres of|within a few metres of|within a few meters of|in the environs of|at a short distance from|a short distance from|a few metres from|a few meters from|a few steps from|a few steps away from|a few metres away from|a few meters away from|a stones throw from|a stones throw away from|hard by|in the immediate vicinity of|in the immediate proximity of|round|all around|all round|not far off from|only a few metres from|close to|in the vicinity of|not far from|around|in the area of|nearby to|close by|somewhere near|within reach of|in close proximity to|nearer to|close up to|surrounding|not far away from|very close to|right near|in proximity to",
    ),
    (
        R::NextTo,
        "next to|beside|along side of|cheek by jowl with|shoulder to shoulder with|wing to wing with|flush with|in line with|parallel with|on a level with|hard up against|up against|right up against|close up against|pressed against|leaning against|leaning on|propped against|touching|bordering|contiguous with|contiguous to|alongside with|by side of|at the flank of|on the flank of|to the side of|on the side of|at side of|to one side of|on one side of|off to the side of|neighboring|neighbour to|wedged against|squeezed against|squeezed next to|nestled against|close beside|close alongside|close next to|tight against|tight up against|side on to|besides|alongside|adjacent to|abreast of|at the side of|right next to|level with|directly next to|side by side with|by the side of|along side|right beside|directly beside|alongside of|flanking|immediately next to|just next to|neighbouring|parallel to",
    ),
    (
        R::FarFrom,
        "far from|far away from|a good distance from|a great distance from|a long distance from|a good way from|quite far from|quite a way from|quite a distance from|remote from|miles from|nowhere near|well clear of|well away|a fair distance from|a long way off from|a considerable distance from|a long way from|well away from|distant from|at a distance from",
    ),
    (
        R::Between,
        "between|in between|in the space between|in the middle between|halfway between|half way between|midway between|in the middle of the gap between|flanked on both sides by|nestled between|caught between|hemmed in between|jammed between|boxed in between|tucked between|tucked in between|trapped between|pinned between|positioned between|placed between|situated between|located between|crammed between|slotted between|from in between|amidst|right between|exactly between|out from between|out between|sandwiched between|wedged between|squeezed between|amid|stuck between|in the gap between|from between",
    ),
    (
        R::Across,
        "opposite|across from|across the street from|across the road from|on the other side of the road from|on the other side of the street from|on the opposite side of the road from|on the opposite side of the street from|on the far side of the road from|over the road from|over the street from|face to face with|vis a vis|on the opposite side from|right across from|straight across from|directly across from|just across from|right opposite|just opposite|diagonally across from|diagonally opposite|opposite of|opposite to|on the other side from|directly opposite|facing across from",
    ),
    (
        R::Blocking,
        "blocking|block|blocks|obstructing|obstructs|obstruct|closing off|closes off|close off|closing|closes|barring|in the way of|on the path of|cutting off|cuts off|blocking off|block off|blocks off|obstructing the way of|sealing off|impeding|standing in the way of|occupying|occupies|taking up|takes up|sealing|cordoning off|cordon off|blockading|is blocking|are blocking|barricading|stopping traffic in|narrowing",
    ),
    (
        R::Facing,
        "nose pointed at|nose pointing at|with its nose towards|with its nose pointing at|with its front towards|with its front facing|with their noses towards|its nose towards|nose towards|nose toward|facing|faces|face|towards|toward|in the direction towards|rushing towards|rush towards|rushes towards|speeding towards|speeds towards|come towards|heads for|racing towards|races towards|looking at|pointing at|pointing towards|pointing to|looking towards|turned towards|oriented towards|heading towards|heading for|heading toward|heading at|walking towards|walking toward|running towards|running toward|walking to|running to|driving towards|driving toward|looking toward|facing towards|facing toward|coming towards|coming toward|approaching|moving towards|moving toward|coming at|approaches|riding towards|riding toward|cycling towards|comes towards|comes toward|drives towards|walks towards|walks toward|runs towards|heads towards|heading straight for|heading straight at|watching|cycling toward|coming straight at|aimed at|headed towards|headed toward|headed for|bearing down on|travelling towards|traveling toward|traveling towards",
    ),
    (
        R::FacingAway,
        "facing away from|with its back turned to|with their back turned to|with his back to|with her back to|with his back turned to|with her back turned to|with their backs turned to|with its rear to|with its rear towards|with its tail to|with its tail towards|with its nose away from|turning its back on|turning their backs on|turning his back on|turning her back on|turns its back on|facing the other way from|directed away from|oriented away from|headed away from|with its rear facing|tail towards|back towards|back to|looking away from|driving away from|walking away from|moving away from|turned away from|going away from|heading away from|with its back to|with their backs to|riding away from|running away from|pointing away from|speeding away from|drives away from|walks away from",
    ),
    (
        R::Following,
        "following|follows|in the tracks of|at the heels of|on the heels of|in tow behind|in convoy with|in convoy behind|right on the tail of|hard on the heels of|in the train of|bringing up the rear of|at the tail end of|in line behind|in file behind|in a line behind|in a queue behind|next in line behind|glued to the bumper of|glued to|follow|tailgating|tailgates|trailing|trails|chasing|chases|driving behind|drives behind|riding behind|closely following|in pursuit of|tailing|close on the heels of|hot on the heels of|queuing behind|queueing behind|queued behind|cycling behind|rides behind|stuck behind|travelling behind|traveling behind|shadowing|pursuing|lined up behind|walking behind",
    ),
    (
        R::Crossing,
        "crossing|crosses|cross|walking across|running across|walks across|runs across|riding across|cycling across|stepping onto|steps onto|jaywalking across|hurrying across|dashing across|running onto|stepping into|walks over|walking over|going across|strolling across|stepping out onto|runs over|running over|rushing across|run across|walk across|goes across|pushing a pram across|pushing a stroller across|dashes across|darting across|stepping off|traversing|driving across|turning across|drives across|steps out onto|steps into|moving across|heading across|about to cross|making their way across|making his way across|making her way across|jogging across|going over|pass over|wandering across|step onto",
    ),
    (
        R::SameDirection,
        "in the same direction as|in the same direction of travel as|in the same sense as|the same way as|the same direction as|same way as|going in the same direction as|moving in the same direction as|driving in the same direction as|travelling in the same direction as|heading in the same direction as|heading the same way as|driving the same way as|moving with|same direction as|travelling with|traveling with|going the same way as|in the direction of",
    ),
    (
        R::OppositeDirection,
        "in the opposite direction to|in the opposite direction from|in the reverse direction to|opposite in direction to|the opposite way to|the other way from|the opposite way from|against|counter to|in the opposite sense to|in the opposite direction of|in the other direction from|against the direction of|opposite direction to",
    ),
];

/// The same, and near.
pub const CLOSE: &[(&[R], &str)] = &[
    (
        &[R::Behind, R::Near],
        "close behind|close behind me|close behind us|close behind the ego|close behind the ego vehicle|close behind my car|close on my tail|tight behind me|tight behind us|hard on my heels",
    ),
    (
        &[R::InFrontOf, R::Near],
        "close ahead|close ahead of me|close ahead of us|close in front|close in front of me|close in front of us|close in front of the ego vehicle",
    ),
];

/// Relations to the ego vehicle that need nothing after them; followed by "of", they take what follows.
pub const EGO_RELATIONS: &[(&[R], &str)] = &[
    (
        &[R::InFrontOf],
        "ahead|in front|in my windscreen|in my windshield|before me|before us|ahead of me|ahead of us|in front of me|in front of us|at the front of us|in view ahead|a little way ahead|a short way ahead|up in front|out front|out in front|up ahead|straight ahead|directly ahead|further ahead|just ahead|right ahead|farther ahead|up front|down the road|down the street|further down the road|upcoming|further on|right in front|directly in front|up the road|immediately ahead|close ahead|dead ahead|further along|straight in front|further down the street|down the lane|further up the road|up the street|ahead on the road|ahead in the road|coming up|in my view ahead|ahead in the distance|at the front|forwards|infront|to the front|in the front|away ahead|off ahead",
    ),
    (
        &[R::InFrontOf, R::FarFrom],
        "in the distance|far ahead|far away ahead|in the far distance|in the background|off in the distance|on the horizon|way in front|well ahead|a long way ahead|far in front|further away|at the far end of the road|at the end of the road|at the end of the street|far down the road|far down the street",
    ),
    (
        &[R::Behind],
        "behind|from behind|coming up from behind|comes up from behind|come up from behind|coming from behind|comes from behind|approaching from behind|approaches from behind|catching up from behind|catches up from behind|closing in from behind|closes in from behind|at the rear|in the back|to the rear|in the rear|further behind|just behind|right behind|at the back|directly behind|in the rear view mirror|in my mirror|in the mirror|in my mirrors|in the mirrors|in the wing mirror|at my back|at our back|on my tail|on our tail|on my bumper|behind my back|at my rear|to our rear|bringing up the rear|in my rear view mirror|behind on the road|close behind|in the rearview mirror|to the back|in my rearview mirror|backwards",
    ),
    (
        &[R::LeftOf],
        "on the left|to the left|at left|on my left|on our left|to my left|to our left|on the left side|on the left hand side|on left|at the left|left|leftwards|to the left hand side|on the left flank|on my left hand side|on my left side|on the lefthand side|to the left side|off to the left|over on the left|left hand side|left side|from the left|at my left|from my left|approaching from the left|coming from the left|arriving from the left|emerging from the left|entering from the left|comes from the left|approaches from the left|coming from my left|approaching from my left|from the left hand side|from our left|on the near left|on the left flank|left of us|left of me|to the left of us|to the left of me|on the ego vehicles left|along the left|down the left|on its left hand|at the left side|on our left hand side|on left side|over to the left|away to the left",
    ),
    (
        &[R::RightOf],
        "on the right|to the right|at right|on my right|on our right|to my right|to our right|on the right side|on the right hand side|on right|at the right|right|rightwards|to the right hand side|on the right flank|on my right hand side|on my right side|on the righthand side|to the right side|off to the right|over on the right|right hand side|right side|from the right|at my right|from my right|approaching from the right|coming from the right|arriving from the right|emerging from the right|entering from the right|comes from the right|approaches from the right|coming from my right|approaching from my right|from the right hand side|from our right|on the near right|on the right flank|right of us|right of me|to the right of us|to the right of me|on the ego vehicles right|along the right|down the right|on its right hand|at the right side|on our right hand side|on right side|over to the right|away to the right",
    ),
    (
        &[R::InFrontOf, R::LeftOf],
        "front left|ahead left|ahead to the left|ahead on the left|in front to the left|in front on the left|ahead and to the left|ahead and left|to the front left|on the front left|at the front left|diagonally left ahead|left ahead|to my front left|ahead to my left|ahead on my left|ahead and to my left|in front and to the left|in front left|forward left|at ten oclock|up ahead on the left|up ahead to the left|to the left ahead|on the left ahead",
    ),
    (
        &[R::InFrontOf, R::RightOf],
        "front right|ahead right|ahead to the right|ahead on the right|in front to the right|in front on the right|ahead and to the right|ahead and right|to the front right|on the front right|at the front right|diagonally right ahead|right ahead on the right|to my front right|ahead to my right|ahead on my right|ahead and to my right|in front and to the right|in front right|forward right|at two oclock|up ahead on the right|up ahead to the right|to the right ahead|on the right ahead",
    ),
    (
        &[R::Behind, R::LeftOf],
        "rear left|back left|behind left|behind to the left|behind on the left|behind and to the left|to the rear left|on the rear left|at the rear left|to my rear left|behind to my left|behind on my left|left behind|behind and left|behind and to my left|at the back left|in the back left",
    ),
    (
        &[R::Behind, R::RightOf],
        "rear right|back right|behind right|behind to the right|behind on the right|behind and to the right|to the rear right|on the rear right|at the rear right|to my rear right|behind to my right|behind on my right|behind and right|behind and to my right|at the back right|in the back right",
    ),
    (
        &[R::Near],
        "nearby|close by|close|in the vicinity|near here|around here|in close proximity",
    ),
    (
        &[R::FarFrom],
        "far away|far off|distant|a long way off|a long way away|far|further off",
    ),
    (
        &[R::SameDirection],
        "in the same direction like me|in the same direction like we|in the same direction like us|same direction like we|in the same direction as we|in the same direction as i|in the same direction as we do|the same way as we do|the same way like us|in the same direction|going the same way as us|the same way|the same direction|the same way as me|the same way as us|the same way i am|the same way as i am|the same direction as me|the same direction as us|the same direction as the ego|the same direction as the ego vehicle|in the same direction as the ego|in the same direction as the ego vehicle|in the same direction of travel|in my direction of travel|in our direction of travel|in the direction of travel|with the traffic|with the flow|with the flow of traffic|along with me|along with us|along with the ego|in line with me|going the same way as me|going the same way as i am|same way as us|same way as me|in the same direction as us|in the same direction as me|going my way|going our way|in my direction|same direction|going the same way|in our direction|same way",
    ),
    (
        &[R::OppositeDirection],
        "in the opposite direction|oncoming|in the opposing direction|in opposite direction|in opposing direction|in the reverse direction|from the other way|from the opposite way|from the front|from ahead|from up ahead|from in front|the other way|the opposite way|the wrong way|wrong way|against the traffic|against the flow|against the flow of traffic|against traffic|against the direction of travel|coming wrong side|comes wrong side|driving wrong side|drives wrong side|coming on the wrong side|driving on the wrong side|on the wrong side of the road|coming from opposite|coming from opposite side|coming from opposite direction|from opposite side|from opposite direction|from the opposite side|in my face|face to face|nose to nose|toward us|towards us|toward me|towards me|towards the ego|towards the ego vehicle|towards my car|towards our car|coming right at me|coming right at us|coming straight at me|coming straight at us|coming at us|coming toward me|coming toward us|coming towards us|coming towards me|comes towards me|comes towards us|comes toward me|comes toward us|come towards me|come towards us|comes at me|comes at us|comes my way|comes our way|come my way|come our way|comes this way|comes the other way|come the other way|comes from the other direction|comes from the opposite direction|heads my way|heads our way|heads this way|heads the other way|drives the other way|drives towards me|drives towards us|driving towards me|driving towards us|drives toward me|drives toward us|driving toward me|driving toward us|rolls towards me|rolls towards us|rolling towards me|rolling towards us|heading towards me|heading towards us|heading toward me|heading toward us|headed towards me|headed towards us|headed toward me|headed toward us|heading straight for me|heading straight for us|heading for me|heading for us|heading at us|heading at me|heading straight at us|heading straight at me|approaching me|approaching us|approaches me|approaches us|approach me|approach us|approaching from ahead|approaching from the front|approaching from up ahead|approaching from the opposite direction|approaching from the other direction|approaching on the opposite side|approaching on the other side|approaches from the opposite direction|approaches from the other direction|approaches from the front|approaches from ahead|coming from the other direction|coming from the other way|coming from the opposite side|coming from in front|coming from straight ahead|coming up the road towards me|coming up the road towards us|coming down the road towards me|coming down the road towards us|going against us|travelling towards me|travelling towards us|traveling towards me|traveling towards us|counterflow|contraflow|meeting us|meeting me|meets us|meets me|coming the other way|going the other way|coming towards|approaching|from the opposite direction|in the other direction|coming from the opposite direction|coming from ahead|on coming|opposing|going the opposite way|coming the opposite way|driving the wrong way|travelling the other way|traveling the other way|heading the other way|coming from the front|from the other direction|opposite direction|going in the opposite direction|heading our way|heading my way|headed our way|headed my way|coming our way|coming my way|heading this way|coming this way|heading towards the camera|against us|head on|driving towards the camera|coming up the other side|travelling the opposite way|driving in the opposite direction|coming in the opposite direction|coming at me|incoming",
    ),
    (&[R::Facing], "facing forward"),
];

/// What is done to the thing named before: "my lane is blocked by cones".
pub const REVERSED: &[(R, &str)] = &[
    (
        R::Blocking,
        "blocked by|is blocked by|are blocked by|closed by|closed off by|obstructed by|barred by|blocked off by|blocked with|closed with|is closed by|is closed off by|cut off by|obstructed with|sealed off by|coned off by|coned off with|blocked off with|occupied by|closed off with|cordoned off by|cordoned off with|is obstructed by|is occupied by|shut by|barricaded by|blocked completely by|partially blocked by|partly blocked by",
    ),
    (
        R::Following,
        "towing|tows|pulling|pulls|hauling|hauls|dragging|followed by|is followed by|are followed by|trailed by|pursued by|chased by|being followed by|tailed by|tailgated by|with behind",
    ),
    (R::InFrontOf, "preceded by|led by|is preceded by|is led by"),
    (
        R::LeftOf,
        "overtaken by|being overtaken by|passed by|being passed by|is overtaken by|is passed by",
    ),
    (R::NextTo, "flanked by|accompanied by"),
    (R::Near, "surrounded by"),
    (R::Crossing, "crossed by|is crossed by"),
    (
        R::On,
        "taken by|is taken by|are taken by|is used by|are used by|is being used by|are being used by|in use by|being used by|taken up by|is taken up by|are taken up by|occupied with|lined with|lined by|is lined with|is lined by|are lined with|are lined by|packed with|filled with|crowded with|is full of|are full of",
    ),
];

/// Places said in a whole phrase, without a noun of their own: relation and anchor.
pub const FIXED: &[(R, Anchor, &str)] = &[
    (
        R::Crossing,
        Anchor::Lane(L::Road),
        "jaywalking|jaywalks|jaywalk|crossing over|stepping out|crosses over|running out",
    ),
    (
        R::WaitingAt,
        Anchor::Crossing,
        "want to cross|would like to cross|wish to cross|wishing to cross|want to cross the road|want to cross the street|want to get across|waiting to cross|waits to cross|wait to cross|wanting to cross|about to cross over|waiting to cross over|ready to cross|wants to cross|waiting to cross the road|waiting to cross the street|waits to cross the road|waits to cross the street|wait to cross the road|wait to cross the street|about to cross the road|about to cross the street|wants to cross the road|wants to cross the street|waiting to cross my lane|ready to cross the road|ready to cross the street",
    ),
    (
        R::On,
        Anchor::Lane(L::Oncoming),
        "on the other side of the divider|on the opposite side of the divider",
    ),
    (R::Near, Anchor::Junction, "turning at the lights"),
    (R::On, Anchor::Lane(L::Road), "in the middle"),
];

/// "Across the street": on its far side, seen from the ego in right-hand traffic.
pub const FAR_SIDE: &str = "on the opposite pavement|on the opposite sidewalk|on the opposite footpath|on the opposite kerb|on the opposite curb|at the opposite kerb|at the opposite curb|on the far pavement|on the far sidewalk|on the far footpath|on the far kerb|on the far curb|at the far kerb|at the far curb|at the far side|on the other pavement|on the other sidewalk|on the other kerb|opposite pavement|opposite sidewalk|opposite kerb|far pavement|far sidewalk|far kerb|far curb|opposite side|other pavement|other sidewalk|opposite side of the road|opposite side of the street|far side of the road|far side of the street|across the street|across the road|on the other side of the road|on the other side of the street|other side of the road|other side of the street|on the opposite side of the road|on the opposite side of the street|on the far side of the road|on the far side of the street|on the other side|on the opposite side|over the road|on the far side|on the other side of the carriageway";
/// One on each side.
pub const BOTH_SIDES: &str = "on opposite sides|on opposing sides|at opposite sides|on the two sides|on opposite sidewalks|on opposite pavements|on opposite footpaths|on opposite kerbs|on opposite curbs|at opposite kerbs|on opposite edges|at opposite edges|opposite sides|on both sidewalks|on both pavements|on both footpaths|both sidewalks|both pavements|on either sidewalk|on each sidewalk|on both kerbs|on both curbs|at both kerbs|on both footways|on both sides|on either side|on each side|both sides|either side|each side|along both sides|on the left and right|left and right|on the left and on the right|to the left and right|on the left and the right|to both sides|at both sides|along each side|down both sides|on the left and right side|on the left and right sides|on the left and right hand side";
/// Prepositions whose meaning depends on the place that follows.
pub const IN: &str = "using|uses|is using|are using|out of|coming out of|comes out of|emerging from|emerges from|emerging out of|turning out of|pulling out of|coming from|in the middle of|in the centre of|in the center of|right in the middle of|into the middle of|onto the middle of|in the very middle of|smack in the middle of|bang in the middle of|in the dead centre of|in|on|onto|into|along|inside|within|over|upon|through|down|up|in the middle of|in the centre of|in the center of|throughout|atop|on top of|all over|all along|occupying part of|out on|on to|inside of|off|line|lines|lining";
/// The same, less exact.
pub const AT: &str = "at|by|outside|waiting for|stopped for|before the|waits for|wait for|stopping for|stops for|stop for|yielding to|yielding for";
/// Next to a strip or an object.
pub const ACROSS: &str = "across";

/// The ego vehicle.
pub const EGO: &str = "my bonnet|our bonnet|my front bumper|our front bumper|my bumper|our bumper|my hood|my windscreen|our windscreen|my windshield|our windshield|my headlights|our headlights|my grille|my front wheels|our front wheels|insured vehicle|insured car|the insured vehicle|the insured car|the insured|policyholders vehicle|policyholders car|insureds vehicle|insureds car|my pupil|my student|my learner|the pupil|my trainee|the learner driver|the learner|my learner driver|my student driver|reporting vehicle|reporting car|reporting driver|subject vehicle|system vehicle|vehicle under test|car under test|vut|sut|my patrol car|our patrol car|my taxi|my van|my truck|my bus|the subject vehicle|subject vehicle|subject car|the subject car|test vehicle|the test vehicle|vehicle under test|the vehicle under test|vut|sut|host|the ego car|my own vehicle|the own car|the own vehicle|camera car|the camera car|recording vehicle|the recording vehicle|data collection vehicle|av|our test vehicle|our test car|test car|the test car|the car i am in|the car im in|the car i drive|the vehicle i drive|the vehicle i am driving|the car i am driving|ego driver|ego truck|the robotaxi i am in|yours truly|you|your car|your vehicle|me|us|ego|my car|our car|my vehicle|our vehicle|the ego vehicle|ego vehicle|ego car|the ego car|myself|host vehicle|own car|own vehicle|my own car|i|we|self|the ego|the av|the camera|camera|mine|ours|driver of the ego|the host|our own car|the viewer|viewer|our own vehicle|host car|ego agent";

/// Words that point back.
pub const PRONOUNS: &str = "the two of them|them both|the pair of them|those two|it|them|they|that|this|those|these|its|their|him|her|he|she|same one|that one|this one|itself|the latter|theirs|each other|one another";
/// Part of a group.
pub const PARTS: &str = "another|another one|a second one|a third one|a second|a third|a fourth|a fifth|a sixth|a seventh|an eighth|a ninth|a tenth|a fourth one|a fifth one|a sixth one|the next one|the next|the farthest one|the furthest one|the rearmost one|the foremost one|the nearer one|the closer one|the farther one|the further one|the more distant one|the nearest one|the farthest one|a further one|one other|the first one|the second one|the third one|the last one|other|other one|others|rest|remaining|remaining ones|the other|the others|the rest|second one|first one|third one|one of them|one of which|ones|the first|the second|the third|the last|the fourth|last one|the former|the other one|the remaining|the other two|the other three|the remaining two|the other four|the other five|the other six|the remaining four|the remaining five|the remaining three";

/// Words that turn around what follows.
pub const NOT: &str = "no|not|without|without any|no more|never|free of|devoid of|lacking|isnt|arent|aint|zero|none|neither|nor|not a single|no single|there are no|there is no|there isnt|there arent|not any|empty of|clear of|absolutely no|absent|minus|except|except for|excluding|nary a|doesnt|dont|wont|dont want|dont include|do not include|with no|having no|avoid|omit|not a|not one|hardly any|is not|are not|but no|no other|sans|rather than|instead of|do not want";

/// Words that carry no meaning here.
pub const FILLERS: &str = "the|soistoo|nearly|almost|practically|virtually|pretty much|more or less|nearfirst|farfirst|had|heavily|fully|completely|anywhere|wed|weve|ive|found|was found|were found|insured|picture this|yet|cant go on|cannot go on|can not go on|dear|so kind|nose to tail|end to end|back to back|in its stead|in their stead|in its place|in their place|in his place|in her place|with a trolley|with trolleys|with a shopping trolley|with a cart|with a suitcase|with shopping|consists out of|hrs|kindly note|kindly|sir|madam|according to the witness|according to witnesses|according to the report|according to the driver|as per the witness|the undersigned observed|the undersigned saw|the undersigned noticed|undersigned|kept|nos|like we|you would like to|youd like to|hazard clip|clip number|clip|weeks|yesterday|lesson|blind spot|the blind spot|serious|why|obliged|in the wrong place|even so|platoon|unprotected left|unprotected left turn|unprotected right|unprotected right turn|protected left|bus stop bypass|halfway|half way|midway|wants|want to|wants to|brief|test|scenario brief|headlamps only|clothing|clothes|dressed|hi vis vest|both of which|both of whom|all of which|all of whom|with its hazards on|with hazards on|with its hazard lights on|with its hazard lights flashing|with hazard lights on|with hazards flashing|hazards flashing|hazards on|its hazards on|with flashing hazards|flashers on|somewhere|whom|free|taken|once|thereafter|likewise|similarly|respectively|elsewhere|in turn|as well|overall|totalling|totaling|namely|ie|eg|that is to say|specifically|in particular|particularly|especially|notably|mainly|mostly|simply|merely|solely|purely|nothing but|nothing more than|nothing other than|none other than|evidently|apparently|seemingly|presumably|obviously|actually|basically|literally|luckily|unfortunately|sadly|by chance|for now|right now|just now|today|at present|presently|at this moment|at this point|constantly|continuously|always|often|sometimes|at the same time|in the meantime|as usual|it seems|it looks like|as if|as though|so that|in order|such|own|respective|thus|hence|therefore|nevertheless|nonetheless|despite|regardless|i have|we have|ive|weve|i can see|we can see|one can see|you can see|can be found|to be seen|is there|are there|is present|are present|there exist|there exists|exists|exist|takes place|is located|are located|is situated|are situated|is found|are found|i notice|we notice|i spot|we spot|i observe|we observe|i encounter|we encounter|i meet|we meet|note that|notice|observe|picture this|think of|say|consider|suppose|assume|stage|stages|comprises|comprising|comprise|consists of|consist of|made of|composed of|is made up of|counting|amounting to|numbering|ball|a ball|a bit|of|there is|there are|theres|there|is|are|was|were|be|been|being|please|show|show me|give me|i want|i would like|id like|generate|create a scene|create|make a scene|scene|a scene|picture|image|view|\
    showing|depicting|depict|depicts|with|and|has|have|having|where|which|who|whose|as|so|then|now|just|very|really|quite|rather|also|too|to|from|for|my|our|your|his|driving scene|street scene|road scene|traffic scene|city scene|\
    situation|scenario|set|setting|featuring|features|feature|containing|contains|includes|including|include|consisting of|made up of|while|when|during|it is|its a|its|at the moment|currently|visible|can be seen|seen|i see|we see|see|you see|i am|im|\
    we are|were|imagine|lets|let|lets have|have a|describe|draw|render|simulate|simulation|video|photo|frame|weather|conditions|condition|sky|skies|under|time|oclock|hours|hour|traffic is|a view of|dash cam|dashcam|street view|day with|\
    exactly|only|just|about|approximately|roughly|around about|at least|at most|maybe|perhaps|possibly|probably|slightly|extremely|pretty|fairly|little bit|somewhat|more or less|directly|immediately|right there|hand|side|typical|total|in total|altogether|\
    place|located|situated|positioned at|found|present|appears|appear|appearing|emerging|emerges|standing there|over there|here|out|off|up|down|away|back|front|something like|like|such as|some kind of|kind of|sort of|type of|all|any|each|every|everyone|whole|entire|\
    their way|his way|her way|slowly moving along|along the way|by itself|on its own|alone|together|at once|again|still|already|in the scene|in view|in sight|around me|around us|in the picture|in the image|of them|atmosphere|mood|lighting|background|foreground|style|environment|surroundings|area|region|location|district|zone|part|section|stretch|spot|position|direction|distance|of distance|during|under|\
    her|his|them all|if|do|does|did|would|could|should|can|will|shall|may|might|must|because|since|until|although|though|however|well|ok|okay|hi|hello|hey|thanks|thank you|near future|first|finally|next|meanwhile|simultaneously|additionally|moreover|furthermore|else|addition|plus|add in|in addition|wait a minute|wait a moment|wait a second|wait a sec|cars lane|than|usual|usually|nothing special|nothing|from my perspective|from the drivers perspective|from the drivers seat|from the ego perspective|perspective|point of view|pov|seen from|dust off|beautiful|nice|lovely|pleasant|good|bad|perfect|great|gentle|soft|cold|cool|freshly|fresh|i drive|we drive|i am driving|im driving|we are driving|driving down|i drive along|we drive along|i am on|we are on|i approach|we approach|i am approaching|we are approaching|approaching an|urban driving scene|drive|covered|everywhere|covering|turns to|seems|seem|looks|look|against|traffic in|traffic on|or so|even|got|get|whilst|amongst|among|amidst|onwards|ready|parts|level|moment|other than that|otherwise|apart from that|that is|that are|who is|who are|which is|which are|thats|whos|the scene|scene of|early|late|rush|season|from left to right|from right to left|left to right|right to left|in pairs|pairs|in a group|in groups|in file|in twos|working|work|in a row|in a line|in line|row|line|one behind the other|one after another|one after the other|in single file|in a queue|blocked|closed|coned off|number of|number|playing|instead|holds|contains only|accident|crawls|trundles|waddles|busily|at work|having a chat|in conversation|hand in hand|full|view|clearly|suddenly|there should be|should be|should|slight|gets|moment|various kinds of|rows|side by side|next to each other|beside each other|abreast|driver|drivers";

/// Length units and the metres in them.
pub const UNITS: &[(f64, &str)] = &[
    (1.0, "m|meter|meters|metre|metres|ms|mtr|mtrs|meteres"),
    (0.3048, "ft|foot|feet"),
    (0.9144, "yd|yard|yards|yds"),
    (1000.0, "km|kilometer|kilometers|kilometre|kilometres|kms"),
    (1609.344, "mile|miles|mi"),
    (0.01, "cm|centimeter|centimeters|centimetre|centimetres"),
    (4.6, "car length|car lengths|cars length|cars lengths"),
    (0.0254, "inch|inches"),
];

/// Half and quarter of a unit.
pub const FRACTIONS: &[(f64, &str)] = &[
    (0.5, "half a|half|a half|half of a"),
    (0.25, "quarter of a|a quarter of a|a quarter|quarter"),
    (1.5, "one and a half|a unit and a half"),
];

/// Words between a distance and what it is measured from.
pub const AWAY: &str = "away from|from|away|off|apart from|distance from|distant from|out from|out";
/// Not farther than.
pub const WITHIN: &str = "within|less than|under|not more than|no more than|at most|closer than|no further than|no farther than|up to|fewer than";
/// Farther than.
pub const BEYOND: &str = "more than|over|at least|further than|farther than|greater than|beyond|no less than";
