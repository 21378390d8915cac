"""How things, places and acts are said: banks of phrases for the generator. {x} is an anchor, {m} a distance, {w} whom it is about."""

NOUNS = {  # (singular, plural)
    "car": [("car", "cars"), ("automobile", "automobiles"), ("sedan", "sedans"), ("saloon", "saloons"), ("hatchback", "hatchbacks"), ("auto", "autos"), ("passenger car", "passenger cars"), ("motor car", "motor cars")],
    "taxi": [("taxi", "taxis"), ("cab", "cabs"), ("taxicab", "taxicabs")],
    "police_car": [("police car", "police cars"), ("patrol car", "patrol cars"), ("cop car", "cop cars")],
    "suv": [("SUV", "SUVs"), ("jeep", "jeeps"), ("off-roader", "off-roaders")],
    "van": [("van", "vans"), ("delivery van", "delivery vans"), ("minivan", "minivans"), ("panel van", "panel vans")],
    "ambulance": [("ambulance", "ambulances")],
    "limousine": [("limousine", "limousines"), ("limo", "limos")],
    "truck": [("truck", "trucks"), ("lorry", "lorries"), ("HGV", "HGVs"), ("goods vehicle", "goods vehicles")],
    "pickup": [("pickup", "pickups"), ("pickup truck", "pickup trucks"), ("ute", "utes")],
    "tanker": [("tanker", "tankers"), ("fuel truck", "fuel trucks"), ("tanker lorry", "tanker lorries")],
    "dump_truck": [("dump truck", "dump trucks"), ("tipper", "tippers"), ("dumper", "dumpers")],
    "garbage_truck": [("garbage truck", "garbage trucks"), ("bin lorry", "bin lorries"), ("refuse truck", "refuse trucks")],
    "fire_truck": [("fire truck", "fire trucks"), ("fire engine", "fire engines")],
    "tow_truck": [("tow truck", "tow trucks"), ("breakdown truck", "breakdown trucks"), ("wrecker", "wreckers")],
    "box_truck": [("box truck", "box trucks"), ("delivery truck", "delivery trucks"), ("moving truck", "moving trucks")],
    "semi": [("semi", "semis"), ("articulated lorry", "articulated lorries"), ("eighteen wheeler", "eighteen wheelers"), ("artic", "artics"), ("big rig", "big rigs")],
    "bus": [("bus", "buses"), ("coach", "coaches"), ("city bus", "city buses"), ("double decker", "double deckers"), ("tour bus", "tour buses")],
    "minibus": [("minibus", "minibuses")],
    "school_bus": [("school bus", "school buses")],
    "trailer": [("trailer", "trailers"), ("cargo trailer", "cargo trailers")],
    "caravan": [("caravan", "caravans")],
    "construction_vehicle": [("construction vehicle", "construction vehicles"), ("construction machine", "construction machines"), ("site vehicle", "site vehicles"), ("machine", "machines")],
    "excavator": [("excavator", "excavators"), ("digger", "diggers"), ("backhoe", "backhoes"), ("JCB", "JCBs")],
    "bulldozer": [("bulldozer", "bulldozers"), ("dozer", "dozers")],
    "crane": [("crane", "cranes"), ("mobile crane", "mobile cranes")],
    "roller": [("road roller", "road rollers"), ("steamroller", "steamrollers"), ("roller", "rollers")],
    "forklift": [("forklift", "forklifts")],
    "tractor": [("tractor", "tractors"), ("farm tractor", "farm tractors")],
    "loader": [("loader", "loaders"), ("wheel loader", "wheel loaders")],
    "cement_mixer": [("cement mixer", "cement mixers"), ("concrete truck", "concrete trucks")],
    "motorcycle": [("motorcycle", "motorcycles"), ("motorbike", "motorbikes"), ("motorcyclist", "motorcyclists"), ("biker", "bikers"), ("moto", "motos")],
    "scooter": [("scooter", "scooters"), ("moped", "mopeds")],
    "bicycle": [("bicycle", "bicycles"), ("cyclist", "cyclists"), ("bike", "bikes"), ("pushbike", "pushbikes"), ("cycle", "cycles"), ("person on a bike", "people on bikes"), ("bicyclist", "bicyclists")],
    "person": [("person", "people"), ("pedestrian", "pedestrians"), ("walker", "walkers"), ("passer-by", "passers-by"), ("human", "humans"), ("ped", "peds"), ("bystander", "bystanders"), ("individual", "individuals"), ("figure", "figures"), ("student", "students"), ("jogger", "joggers"), ("tourist", "tourists")],
    "man": [("man", "men"), ("guy", "guys"), ("bloke", "blokes"), ("gentleman", "gentlemen"), ("chap", "chaps"), ("dude", "dudes"), ("lad", "lads")],
    "woman": [("woman", "women"), ("lady", "ladies")],
    "child": [("child", "children"), ("kid", "kids"), ("boy", "boys"), ("girl", "girls"), ("schoolchild", "schoolchildren")],
    "worker": [("worker", "workers"), ("construction worker", "construction workers"), ("workman", "workmen"), ("road worker", "road workers"), ("builder", "builders")],
    "policeman": [("police officer", "police officers"), ("policeman", "policemen"), ("cop", "cops"), ("officer", "officers")],
    "cone": [("cone", "cones"), ("traffic cone", "traffic cones"), ("pylon", "pylons"), ("road cone", "road cones")],
    "barrier": [("barrier", "barriers"), ("barricade", "barricades"), ("roadblock", "roadblocks"), ("fence", "fences"), ("jersey barrier", "jersey barriers")],
    "vehicle": [("vehicle", "vehicles"), ("motor vehicle", "motor vehicles")],
    "two_wheeler": [("two-wheeler", "two-wheelers")],
    "thing": [("object", "objects"), ("thing", "things"), ("item", "items")],
    "one": [("one", "ones")],
}
COMMON = ["car"] * 6 + ["truck"] * 4 + ["bus"] * 4 + ["person"] * 7 + ["bicycle"] * 4 + ["motorcycle"] * 3 + ["cone"] * 4 + ["barrier"] * 3 + ["trailer"] * 2 + ["construction_vehicle"] * 2 + ["excavator", "van", "taxi", "child", "man", "woman", "worker"]
LIVING = {"person", "man", "woman", "child", "worker", "policeman"}
CYCLES = {"motorcycle", "scooter", "bicycle"}
FIXED = {"cone", "barrier"}

PAINTS = {"grey": ["grey", "gray"], "silver": ["silver"], "red": ["red", "red", "crimson"], "blue": ["blue", "blue", "navy"], "brown": ["brown"], "black": ["black"], "white": ["white"], "orange": ["orange"], "yellow": ["yellow"], "green": ["green"], "purple": ["purple"], "pink": ["pink"], "beige": ["beige", "cream"]}

EGO = ["me", "us", "me", "us", "ego", "the ego vehicle", "our car", "my car", "the ego", "our vehicle", "my vehicle", "the test car", "my bumper", "the camera car"]
MY = ["my", "our", "the ego", "my", "our", "ego's"]

ANCHORS = {
    "crossing": ["the crossing", "the crosswalk", "the zebra crossing", "the zebra", "the pedestrian crossing", "the stripes", "a crosswalk", "a zebra crossing"],
    "junction": ["the junction", "the intersection", "the crossroads", "the corner"],
    "ego_lane": ["{my} lane", "{my} lane", "{my} own lane", "the lane {i} drive in", "the same lane as me", "the ego lane", "lane ego", "{my} path"],
    "left_lane": ["the left lane", "the left-hand lane", "the lane to {my} left", "the lane left of {mine}", "the next lane on the left"],
    "right_lane": ["the right lane", "the right-hand lane", "the lane to {my} right", "the lane right of {mine}", "the next lane on the right"],
    "oncoming_lane": ["the oncoming lane", "the opposite lane", "the opposing lane", "the lane for oncoming traffic", "the other lane"],
    "cross_street": ["the cross street", "the side street", "the side road"],
    "road": ["the road", "the street", "the roadway", "the carriageway"],
    "roadside": ["the roadside", "the kerb", "the curb", "the side of the road", "the edge of the road"],
    "left_roadside": ["the left kerb", "the left curb", "the left side of the road", "the left roadside", "the left-hand kerb", "the left edge of the road", "the left side of the street", "the kerb on the left", "the left shoulder"],
    "right_roadside": ["the right kerb", "the right curb", "the right side of the road", "the right roadside", "the right-hand kerb", "the right edge of the road", "the right side of the street", "the curb on the right", "the right shoulder"],
    "sidewalk": ["the sidewalk", "the pavement", "the footpath", "the walkway", "the footway"],
    "left_sidewalk": ["the left sidewalk", "the left pavement", "the left-hand pavement", "the sidewalk on the left", "the left footpath", "the pavement to {my} left", "the left walkway", "the footway on the left"],
    "right_sidewalk": ["the right sidewalk", "the right pavement", "the right-hand pavement", "the sidewalk on the right", "the right footpath", "the pavement to {my} right", "the right walkway", "the footway on the right"],
    "carpark": ["the car park", "the parking lot", "the parking area", "a car park", "a parking lot"],
}

# phrases for places; {x} the anchor, {m} the distance
PLACES = {
    ("ahead", "ego"): ["in front of {x}", "ahead of {x}", "ahead", "in front", "up ahead", "before {x}", "straight ahead", "up the road", "down the road", "out in front", "further up the street", "ahead of {x}"],
    ("ahead", "ego", "m"): ["{m} ahead of {x}", "{m} in front of {x}", "{m} ahead", "{m} in front", "at {m} ahead", "{m} up the road", "{m} down the road", "{m} up ahead", "ahead at {m}", "in front of {x} at {m}", "ahead of {x} at a distance of {m}", "{m} before {x}", "{m} down the street", "around {m} ahead of {x}", "about {m} in front of {x}", "{m} out in front", "in front of {x}, {m} away"],
    ("behind", "ego"): ["behind {x}", "in back of {x}", "at the back", "to {my} rear", "behind", "in the rear", "on {my} tail", "in {my} mirror", "following {x}"],
    ("behind", "ego", "m"): ["{m} behind {x}", "{m} behind", "{m} back", "behind {x} at {m}", "{m} to {my} rear", "about {m} behind {x}"],
    ("left", "ego"): ["on the left", "to the left", "on {my} left", "to {my} left", "on the left side", "left of {x}", "on the left-hand side", "to the left of {x}", "off to the left", "left"],
    ("right", "ego"): ["on the right", "to the right", "on {my} right", "to {my} right", "on the right side", "right of {x}", "on the right-hand side", "to the right of {x}", "off to the right", "right"],
    ("left", "ego", "m"): ["{m} to the left", "{m} left of {x}", "{m} to {my} left", "on the left at {m}"],
    ("right", "ego", "m"): ["{m} to the right", "{m} right of {x}", "{m} to {my} right", "on the right at {m}"],
    ("near", "ego"): ["near {x}", "close to {x}", "close by", "nearby"],
    ("next_to", "ego"): ["next to {x}", "right beside {x}", "alongside {x}", "beside {x}"],
    ("far", "ego"): ["far away", "in the distance", "far from {x}", "far off", "a long way off"],
    ("at", "ego", "m"): ["{m} away", "{m} from {x}", "at {m}", "at a distance of {m}", "{m} away from {x}", "{m} off", "with {m} between {x} and it"],
    ("oncoming", "ego"): ["coming towards {x}", "oncoming", "coming the other way", "approaching {x}", "heading towards {x}", "driving towards {x}", "coming at {x}", "in the opposite direction", "going the other way", "against {my} direction", "which comes to meet {x}", "coming from the opposite direction"],
    ("oncoming", "ego", "m"): ["coming towards {x} {m} ahead", "oncoming {m} ahead", "{m} away, coming towards {x}", "approaching {x} at {m}"],
    ("same_way", "ego"): ["going the same way as {x}", "in the same direction as {x}", "heading {my} way", "travelling in {my} direction", "driving the same way", "in {my} direction of travel"],
    ("facing", "ego"): ["facing {x}", "looking at {x}", "facing towards {x}", "turned towards {x}", "looking towards {x}", "staring at {x}", "with the front to {x}"],
    ("facing_away", "ego"): ["facing away from {x}", "looking away from {x}", "with the back to {x}", "turned away from {x}"],
    ("following", "ego"): ["following {x}", "driving behind {x}", "tailing {x}", "right on {my} tail"],
    ("blocking", "ego_lane"): ["blocking {x}", "that blocks {x}", "across {x}", "obstructing {x}", "in the way in {x}"],
    ("blocking", "road"): ["blocking {x}", "that blocks {x}", "across {x}"],
    ("blocking", "crossing"): ["blocking {x}", "that blocks {x}"],
    ("crossing", "road"): ["crossing {x}", "walking across {x}", "stepping into {x}", "jaywalking", "running across {x}", "who crosses {x}"],
    ("on", "crossing"): ["on {x}", "crossing at {x}", "walking over {x}", "using {x}", "walking across {x}", "in the middle of {x}", "going over {x}"],
    ("waiting", "crossing"): ["waiting at {x}", "at {x}, waiting", "about to cross at {x}", "who wait at {x}", "stopped at {x}", "standing at {x}", "waiting to cross at {x}"],
    ("near", "crossing"): ["near {x}", "close to {x}", "by {x}", "next to {x}", "just before {x}"],
    ("on", "junction"): ["in {x}", "in the middle of {x}", "crossing {x}", "inside {x}"],
    ("waiting", "junction"): ["waiting at {x}", "stopped at {x}", "halted at {x}", "standing at {x}"],
    ("near", "junction"): ["near {x}", "close to {x}", "at {x}", "by {x}"],
    ("on", "lane"): ["in {x}", "in {x}", "on {x}", "driving in {x}", "within {x}"],
    ("on", "strip"): ["at {x}", "on {x}", "along {x}", "by {x}"],
    ("on", "walk"): ["on {x}", "on {x}", "along {x}", "standing on {x}"],
    ("on", "carpark"): ["in {x}", "on {x}", "at {x}"],
    ("on", "road"): ["on {x}", "in the middle of {x}", "in {x}"],
    ("on", "cross_street"): ["in {x}", "on {x}", "coming out of {x}"],
    ("ahead", "thing"): ["in front of {x}", "ahead of {x}", "before {x}", "at the front of {x}"],
    ("ahead", "thing", "m"): ["{m} in front of {x}", "{m} ahead of {x}", "{m} before {x}"],
    ("behind", "thing"): ["behind {x}", "in back of {x}", "at the rear of {x}", "after {x}", "just behind {x}", "right behind {x}"],
    ("behind", "thing", "m"): ["{m} behind {x}", "{m} after {x}"],
    ("left", "thing"): ["to the left of {x}", "left of {x}", "on the left of {x}", "on the left side of {x}"],
    ("right", "thing"): ["to the right of {x}", "right of {x}", "on the right of {x}", "on the right side of {x}"],
    ("near", "thing"): ["near {x}", "close to {x}", "by {x}", "around {x}", "in the vicinity of {x}"],
    ("next_to", "thing"): ["next to {x}", "beside {x}", "right next to {x}", "alongside {x}", "by the side of {x}", "right by {x}"],
    ("far", "thing"): ["far from {x}", "far away from {x}"],
    ("at", "thing", "m"): ["{m} from {x}", "{m} away from {x}"],
    ("facing", "thing"): ["facing {x}", "looking at {x}", "turned towards {x}"],
    ("facing_away", "thing"): ["facing away from {x}", "with the back to {x}", "looking away from {x}"],
    ("following", "thing"): ["following {x}", "driving behind {x}", "trailing {x}", "that follows {x}", "tailing {x}", "chasing {x}"],
    ("across", "thing"): ["across the street from {x}", "across from {x}", "opposite {x}", "on the other side of the road from {x}"],
    ("between", "thing"): ["between {x} and {y}", "in between {x} and {y}", "sandwiched between {x} and {y}", "halfway between {x} and {y}", "squeezed in between {x} and {y}"],
    ("between", "two"): ["between {x}", "in between {x}"],
    ("like", "thing"): ["in the same lane as {x}", "on the same side as {x}", "on the same pavement as {x}", "where {x} stands", "with {x}"],
    ("in_line",): ["in a row", "in a queue", "one behind another", "nose to tail", "in a line", "queued up", "one after the other", "lined up"],
    ("side_by_side",): ["side by side", "next to each other", "abreast", "beside each other"],
    ("there",): ["there", "in its place", "in that spot", "instead"],
}

STATES = {
    "parked": (["parked"], ["that is parked", "parked up", "left standing there", "which has parked"]),
    "waiting": (["stopped", "standing", "waiting", "stationary", "halted", "idle"], ["that has stopped", "standing still", "waiting", "standing there", "at a standstill"]),
    "moving": (["moving", "driving"], ["driving along", "on the move", "that drives", "moving along"]),
}
WALKS = {
    "waiting": (["standing", "waiting"], ["standing there", "standing around", "waiting", "standing still", "who just stands there"]),
    "moving": (["walking"], ["walking", "on the move", "strolling", "walking along", "taking a walk", "running"]),
}
RIDES = {
    "moving": (["moving"], ["riding along", "cycling along", "rolling along", "riding", "pedalling along"]),
    "parked": (["parked"], ["parked", "left standing", "leaning there"]),
    "waiting": (["waiting", "stopped"], ["waiting", "stopped", "standing still"]),
}
SIZES = {"small": ["small", "little", "tiny", "compact"], "large": ["large", "big", "huge", "long", "giant"]}

TIMES = {
    "dawn": ["at dawn", "at sunrise", "early in the morning, the sun just rising", "at daybreak", "dawn", "at first light", "sunrise", "as the sun comes up", "crack of dawn"],
    "day": ["by day", "in daylight", "during the day", "at noon", "daytime", "in broad daylight", "midday", "in the afternoon", "day"],
    "dusk": ["at dusk", "at sunset", "in the evening twilight", "dusk", "as the sun sets", "sunset", "sundown"],
    "night": ["at night", "by night", "after dark", "in the middle of the night", "night", "night-time", "in the dark", "at midnight"],
}
WEATHERS = {
    "clear": ["clear weather", "under a clear sky", "sunny", "in bright sunshine", "clear sky", "not a cloud in the sky", "fair weather", "clear"],
    "overcast": ["overcast", "under a cloudy sky", "cloudy", "grey sky", "under an overcast sky", "clouds overhead"],
    "rain": ["in the rain", "rainy", "raining", "pouring rain", "in heavy rain", "wet weather", "rain", "drizzle"],
    "snow": ["in the snow", "snowing", "snowy", "snow", "snowfall", "in a snowstorm"],
    "fog": ["in fog", "foggy", "in thick fog", "mist everywhere", "dense fog", "fog", "misty"],
    "sandstorm": ["in a sandstorm", "sandstorm", "dust storm", "sand blowing everywhere", "in a dust storm"],
}
TIME_ADJ = {"night": "night", "dawn": "dawn", "dusk": "dusk", "day": "daytime"}
WEATHER_ADJ = {"rain": "rainy", "snow": "snowy", "fog": "foggy", "clear": "sunny", "overcast": "cloudy", "sandstorm": "dusty"}
ROADS = {
    "straight": ["a straight road", "a straight street", "straight road", "a straight stretch of road"],
    "curve": ["a curve", "a bend", "a winding road", "a curved road", "a bend in the road"],
    "t_junction": ["a T-junction", "a T-intersection", "t junction", "a T crossing"],
    "intersection": ["an intersection", "a crossroads", "a four-way intersection", "a junction", "intersection", "4-way"],
    "roundabout": ["a roundabout", "roundabout", "a traffic circle"],
    "highway": ["a highway", "the motorway", "a freeway", "highway", "a motorway", "an expressway"],
    "parking": ["a parking lot", "a car park", "a parking area"],
    "suburb": ["a suburban street", "a residential street", "a street with driveways"],
}
ENVS = {"downtown": ["downtown", "in the city centre"], "urban": ["in the city", "urban"], "suburban": ["in the suburbs", "suburban"], "residential": ["in a residential area", "residential"], "rural": ["in the countryside", "rural"], "industrial": ["in an industrial area", "industrial estate"], "nature": ["in the woods", "in the mountains"]}
DENSITIES = {"busy": ["busy", "heavy traffic", "lots of traffic", "rush hour"], "jam": ["a traffic jam", "stuck in traffic", "gridlock"], "light": ["light traffic", "hardly any traffic", "quiet"], "empty": ["an empty road", "no traffic", "deserted", "nobody around"]}
HAS = {"crossing": ["a zebra crossing", "a crosswalk", "a pedestrian crossing"], "sidewalk": ["a sidewalk", "pavements", "sidewalks on both sides"]}

REMOVE = ["remove {w}", "delete {w}", "take {w} away", "take away {w}", "take out {w}", "get rid of {w}", "lose {w}", "drop {w}", "{w} should go", "{w} can go", "{w} must go", "erase {w}", "no more {w_bare}", "kill {w}", "{w} out", "scrap {w}", "{w} away", "i don't want {w}", "i don't need {w} any more", "make {w} disappear", "{w} has to go", "{w} vanishes", "strip out {w}", "{w} gone", "clear away {w}", "without {w} please", "ditch {w}", "cut {w}", "chuck {w} out", "wipe {w}", "{w} left", "{w} drove off", "{w} is gone", "bin {w}", "{w} shouldn't be there", "please let {w} vanish", "eliminate {w}", "we don't need {w}", "{w}: remove", "{w} is superfluous", "strike {w}", "{w} shall not be there any more"]
ADD = ["add {t}", "put {t}", "place {t}", "insert {t}", "{t}", "there should be {t}", "i want {t}", "give me {t}", "i need {t}", "let there be {t}", "drop in {t}", "throw in {t}", "we also need {t}", "how about {t}", "i'd like {t}", "bring in {t}", "have {t}", "also {t}", "plus {t}", "spawn {t}", "{t} too", "show {t}", "set {t}", "stick {t}", "create {t}", "please add {t}", "{t} appears", "there is now {t}", "{t} has arrived", "could we have {t}", "{t} would be nice", "{t} is missing, add it", "now with {t}"]
MORE = ["add {n} more {s}", "{n} more {s}", "another {n} {s}", "{n} additional {s}", "{n} extra {s}", "add another {n} {s}", "{n} further {s}"]
ANOTHER = ["another {s}", "one more {s}", "a second {s}", "add another {s}", "an extra {s}", "an additional {s}", "a further {s}"]
KEEP = ["keep only {w}", "only {w} should stay", "remove everything but {w}", "delete everything except {w}", "just {w}, nothing else", "nothing but {w} stays", "leave only {w}", "lose everything except {w}", "only {w} remains", "all but {w} must go", "only {w} please, the rest goes", "get rid of all but {w}", "{w} and nothing else", "everything else goes, {w} stays", "keep {w} and drop the rest", "only keep {w}"]
LEAVE = ["{w} stays", "leave {w} as it is", "don't touch {w}", "{w} is fine", "keep {w}", "{w} can stay", "leave {w} alone", "{w} remains where it is", "but not {w}", "hang on to {w}", "{w} stays put", "{w} unchanged", "do not move {w}"]
LEAVE_REST = ["the rest stays", "leave the rest", "everything else stays as it is", "rest is fine", "don't touch anything else", "keep everything else", "otherwise unchanged", "the rest as before", "everything else is fine", "no other changes"]
REPLACE = ["replace {w} with {t}", "replace {w} by {t}", "swap {w} for {t}", "turn {w} into {t}", "change {w} to {t}", "change {w} into {t}", "make {w} {t}", "{t} instead of {w}", "substitute {t} for {w}", "exchange {w} for {t}", "{w} becomes {t}", "{w} should be {t}", "{w} is actually {t}", "put {t} where {w} is", "{w} out, {t} in", "i want {t} in place of {w}", "make {t} out of {w}", "trade {w} for {t}", "convert {w} into {t}", "instead of {w} i'd like {t}", "{w} -> {t}", "that's not {w_a}, it's {t}", "where {w} is there should be {t}", "have {t} take the place of {w}", "{t}, not {w_a}"]
MOVE_TO = ["move {w} {p}", "put {w} {p}", "place {w} {p}", "bring {w} {p}", "set {w} {p}", "{w} should be {p}", "{w} must be {p}", "{w} goes {p}", "shift {w} {p}", "i want {w} {p}", "{w} {p}", "{w} is {p} now", "{w} belongs {p}", "get {w} {p}", "have {w} {p}", "take {w} {p}", "relocate {w} {p}", "{w} needs to be {p}", "send {w} {p}", "{w}: {p}", "let {w} be {p}", "drag {w} {p}", "{w} was {p}", "{w} wants to be {p}", "reposition {w} {p}", "stick {w} {p}", "{w} moved {p}", "make {w} stand {p}", "{w} should stand {p}", "{w} actually was {p}"]
TO_RANGE = ["move {w} to {m}", "put {w} at {m}", "{w} should be at {m}", "{w} at {m}", "{w} should be {m} away", "bring {w} to {m}", "{w} was at {m}", "set the distance to {w} to {m}", "{w} only {m} away", "make it {m} to {w}", "{w} {m} from me", "{w}: {m}", "i want {w} {m} away from us", "the gap to {w} is {m}", "{w} is {m} away, not {o}", "{w} at {m} instead of {o}", "{w} to {m}, not {o}"]
NEARER = ["move {w} {m} closer", "bring {w} {m} nearer", "{w} {m} closer", "move {w} {m} towards me", "{w} should be {m} closer", "pull {w} {m} nearer to us", "{w} comes {m} nearer", "nudge {w} {m} towards us", "{m} nearer with {w}"]
NEARER_0 = ["move {w} closer", "bring {w} nearer", "{w} closer", "{w} should be closer to me", "{w} comes nearer", "get {w} nearer to us", "move {w} towards me", "{w} is too far away"]
AWAY = ["move {w} {m} farther away", "push {w} back by {m}", "{w} {m} further away", "{w} {m} further off", "move {w} {m} away from me", "{w} should be {m} farther away", "push {w} {m} away", "{w} {m} more distance"]
AWAY_0 = ["move {w} farther away", "push {w} further away", "{w} further away", "{w} should be farther from me", "{w} is too close", "move {w} away from us", "give {w} more distance"]
BY = {
    "left": ["move {w} {m} to the left", "shift {w} left by {m}", "{w} {m} left", "nudge {w} {m} left", "{w} {m} to the left", "slide {w} {m} leftwards"],
    "right": ["move {w} {m} to the right", "shift {w} right by {m}", "{w} {m} right", "nudge {w} {m} right", "{w} {m} to the right", "slide {w} {m} rightwards"],
    "forward": ["move {w} {m} forward", "{w} {m} forward", "move {w} forward by {m}", "push {w} {m} ahead", "shift {w} {m} forwards", "{w} {m} further up the road", "move {w} {m} up the road"],
    "back": ["move {w} back {m}", "{w} {m} back", "move {w} backwards by {m}", "shift {w} {m} backward", "{w} {m} further back"],
}
BY_0 = {
    "left": ["move {w} to the left", "shift {w} left", "{w} a bit left", "{w} further left", "{w} more to the left"],
    "right": ["move {w} to the right", "shift {w} right", "{w} a bit right", "{w} further right", "{w} more to the right"],
    "forward": ["move {w} forward", "{w} a bit forward", "move {w} ahead a little"],
    "back": ["move {w} back", "{w} a bit back", "move {w} backwards a little"],
}
LANES = {
    "lane_left": ["move {w} one lane to the left", "{w} changes to the lane on its left", "shift {w} a lane left", "{w} one lane left", "move {w} over a lane to the left"],
    "lane_right": ["move {w} one lane to the right", "shift {w} a lane right", "{w} one lane right", "move {w} over a lane to the right"],
}
TIMES_FAR = {2: ["{w} twice as far away", "double the distance to {w}", "put {w} twice as far"], 0.5: ["{w} half as far away", "halve the distance to {w}", "{w} at half the distance"]}
TURN = ["turn {w} around", "{w} turns around", "rotate {w} by 180 degrees", "flip {w}", "turn {w} about", "spin {w} round", "{w} the other way round", "{w} should face the other way", "make {w} face the other way", "u-turn for {w}", "reverse the direction of {w}", "point {w} the other way", "half-turn for {w}"]
TURN_SIDE = {"left": ["turn {w} to the left", "rotate {w} 90 degrees left", "turn {w} left", "rotate {w} counterclockwise by 90 degrees"], "right": ["turn {w} to the right", "rotate {w} 90 degrees right", "turn {w} right", "rotate {w} clockwise by 90 degrees"], "along": ["line {w} up with the lane", "turn {w} along its lane", "align {w} with its lane"]}
TURN_TO = {
    ("facing", "ego"): ["turn {w} to face me", "{w} should face us", "{w} looks at me", "make {w} face us", "turn {w} towards me", "{w} facing us"],
    ("facing_away", "ego"): ["turn {w} away from me", "{w} should face away", "{w} shows us its back", "make {w} look away"],
    ("oncoming", "ego"): ["{w} should come towards me", "make {w} oncoming", "{w} comes the other way", "turn {w} so that it comes towards us", "{w} drives towards us", "have {w} approach us", "{w} heads towards us instead"],
    ("same_way", "ego"): ["{w} should go the same way as me", "make {w} drive in our direction", "{w}: our direction", "turn {w} to go our way", "{w} goes the same way as us", "{w} heads in my direction"],
    ("facing", "thing"): ["turn {w} to face {x}", "{w} should look at {x}", "{w} faces {x}"],
}
PAINT = ["make {w} {c}", "paint {w} {c}", "{w} should be {c}", "{w} is {c}", "color {w} {c}", "colour {w} {c}", "{w} in {c}", "{w}: {c}", "turn {w} {c}", "{w} must be {c}", "give {w} a {c} paint job", "i want {w} to be {c}", "change {w} to {c}", "{w} becomes {c}", "change the colour of {w} to {c}", "{w} gets {c}", "{w} {c} please", "have {w} painted {c}", "{w} turned {c}", "repaint {w} {c}", "switch {w} to {c}", "{w} -> {c}", "make {w} {c} instead"]
PAINT_OF = ["{w} in the same colour as {x}", "make {w} the same color as {x}", "{w} gets the colour of {x}", "paint {w} like {x}", "give {w} the colour of {x}", "{w} takes on the same colour as {x}"]
SET_STATE = {
    "parked": ["park {w}", "{w} should be parked", "{w} is parked", "have {w} park", "make {w} parked", "{w} has parked"],
    "moving": ["{w} should be moving", "{w} drives off", "make {w} move", "let {w} drive", "{w} is moving", "get {w} moving", "{w} starts driving", "set {w} in motion"],
    "waiting": ["stop {w}", "{w} stops", "{w} should stand still", "make {w} wait", "{w} has stopped", "halt {w}", "bring {w} to a stop", "{w} is stationary"],
}
SET_SIZE = {"large": ["make {w} bigger", "{w} should be larger", "enlarge {w}"], "small": ["make {w} smaller", "{w} should be smaller", "shrink {w}"]}
COUNT = ["there should be {n} {s}", "make it {n} {s}", "only {n} {s}", "{n} {s} in total", "exactly {n} {s}", "i want {n} {s} altogether", "reduce the {s} to {n}", "bump the {s} up to {n}", "set the number of {s} to {n}", "{n} {s} instead", "{s}: {n}", "just {n} {s}", "the number of {s} should be {n}", "only {n} of the {s} should remain", "keep only {n} of the {s}", "down to {n} {s}", "leave {n} of the {s}", "{s} x {n}", "bring the {s} to {n}", "{n} {s} are enough", "thin out the {s} until {n} are left", "make that {n} {s}"]
TIMES_N = {2: ["double the {s}", "twice as many {s}", "double the number of {s}", "two times the {s}", "double up on the {s}"], 3: ["triple the {s}", "three times as many {s}", "triple the number of {s}"], 4: ["quadruple the {s}", "four times as many {s}"], 0.5: ["halve the {s}", "half of the {s} are enough", "half as many {s}", "cut the number of {s} in half", "only half the {s}"]}
SWAP = ["swap {w} and {x}", "{w} and {x} swap places", "exchange {w} and {x}", "switch the places of {w} and {x}", "let {w} and {x} trade places", "swap the positions of {w} and {x}", "interchange {w} with {x}"]
TIME_SET = ["make it {t}", "{t}", "it should be {t}", "change the time to {t}", "set it {t}", "switch to {t}", "now {t}", "let it be {t}", "the same {t}", "time: {t}", "change to {t}", "turn it to {t}", "this plays {t}", "{t} instead"]
WEATHER_SET = ["make it {t}", "{t}", "add {t}", "change the weather to {t}", "let there be {t}", "now {t}", "weather: {t}", "the weather should be {t}", "it's {t}", "with {t}", "the same with {t}", "switch to {t}", "some {t} please", "turn on {t}"]
WEATHER_EVENTS = {
    "rain": ["it starts raining", "let it rain", "it's pouring", "rain falls", "make it rain", "it is raining", "rain sets in"],
    "snow": ["let it snow", "it's snowing", "snow falls", "it has begun to snow", "make it snow"],
    "fog": ["fog rolls in", "the fog comes up", "it gets foggy", "fog covers everything"],
    "clear": ["the fog lifts", "the rain stops", "the sky clears", "the sun comes out", "no more rain", "stop the rain", "the clouds go away", "blue sky again", "turn off the rain", "lose the fog", "no fog"],
    "overcast": ["clouds gather", "the sky clouds over", "it gets cloudy"],
    "sandstorm": ["a sandstorm whips up", "sand blows across the road", "a dust storm comes up"],
}
TIME_EVENTS = {"night": ["night falls", "it gets dark", "turn off the sun", "kill the daylight", "it is dark now"], "day": ["the sun is up", "let there be daylight", "turn the night into day", "it is day again"], "dusk": ["the sun sets", "the sun is going down"], "dawn": ["the sun comes up", "day is breaking"]}
NONE = ["no {s}", "without {s}", "no {s} at all", "zero {s}", "not a single {one}", "no {s} anywhere", "there are no {s}", "don't include any {s}", "{s}: 0", "free of {s}"]
NO_OTHER = ["nothing else", "no other traffic", "that's it", "nothing more", "nobody else around", "that is all", "otherwise empty", "no one else", "nothing else on the road", "only that"]

OPENINGS = ["", "", "", "", "", "", "", "", "please ", "can you ", "could you ", "hey, ", "ok, ", "now ", "um ", "so ", "well, ", "let's see, ", "i think ", "would you kindly ", "i want you to ", "next: ", "ok so ", "right, ", "for the test: ", "hmm, ", "alright "]
CLOSINGS = ["", "", "", "", "", "", "", "", "", " please", " thanks", ", thank you", ", cheers", " ok?", " if you can", ", will you", "!", " i think", ", for the demo", " now", " instead", ", would you", " pls", " for me"]
SCENES = ["", "", "", "", "a scene with ", "scene: ", "show me ", "i need a scene with ", "make a scene with ", "give me ", "generate ", "create ", "we see ", "there is ", "imagine ", "picture this: ", "a picture of ", "i'd like to see ", "draw ", "test case: ", "scenario: ", "i want ", "let's have ", "could you show "]
JOINS = [", ", " and ", ". ", "; ", " and also ", ", and ", ". also ", ". then ", " plus ", ". and ", ", then ", ", plus ", " & ", " + ", ". oh and ", ". additionally ", "\n"]
