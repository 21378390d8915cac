//! Lists of words and phrases, joined by bars, that the other files look for.

use std::sync::LazyLock;

/// Phrases that are looked for.
pub type List = LazyLock<Vec<&'static str>>;

macro_rules! lists {
    ($($(#[$doc:meta])* $name:ident = $words:literal;)+) => {
        $($(#[$doc])* pub static $name: List = LazyLock::new(|| $words.split('|').collect());)+
    };
}

lists! {
    /// Verbs that only carry another, and adverbs that stand among them.
    HELPERS = "has|have|had|is|are|was|were|be|been|being|am|should|must|shall|ought|needs|need|can|could|may|will|would|might|gets|get|\
        got|wants|belongs|do|does|did|itll|hell|shell|theyll|better";
    /// Words that may stand among helpers.
    ADVERBS = "to|now|just|already|also|please|then|simply|supposed|meant|both|all|completely|finally|rather|instead|suddenly|meanwhile|\
        currently|so|really|actually|still|probably|definitely|going|required|expected|allowed|asked|told|possibly|perhaps|\
        preferably|ideally|always|clearly|best|quickly|slowly|slightly|immediately|kindly|obliged|due|about|made|able";
    /// Helpers and adverbs that turn the rest around.
    NEGATED = "shouldnt|mustnt|isnt|arent|wasnt|werent|doesnt|dont|didnt|cant|cannot|wont|neednt|hasnt|havent|hadnt|wouldnt|couldnt|not|\
        never|aint";
    /// Subjects that point back.
    PRONOUNS = "it|he|she|they|hes|shes|theyre|itll|hell|shell|theyll|itd|hed|shed|theyd";
    /// Words of `frame.rs`.
    OPENERS = "and|but|so|then|now|please|pls|ok|okay|oh|well|hey|hi|hello|yo|bro|dude|mate|sorry|hmm|actually|also|next|finally|nope|\
        yes|yeah|wait|ah|just|kindly|maybe|perhaps|simply|additionally|afterwards|meanwhile|apparently|evidently|\
        on second thought|on second thoughts|in reality|in fact|as it turns out|it turns out that|it turned out that|\
        it turns out|turns out|turned out|in addition|after that|on closer inspection|upon closer inspection|upon inspection|\
        upon reflection|on reflection|correction|now then|first of all|in the meantime|by now|to be precise|at this point|\
        i think|i guess|i suppose|i believe|as a matter of fact|in the end|could you please|can you please|would you please|\
        will you please|could you|can you|would you|will you|can we|could we|would you mind|you should|you can|you may|you must|\
        go ahead and|feel free to|be so kind as to|be so kind and|time to|try to|lets|let us|i would like you to|id like you to|\
        i want you to|i need you to|we should|we need to|we have to|we must|why not|why dont you|why dont we|how about|\
        what about|make sure to|make sure that|make sure|be sure to|remember to|dont forget to|id ask you to|i would ask you to|\
        may i ask you to|i ask you to|is it possible to|would it be possible to|would it be ok to|do me a favour and|\
        do me a favor and|it is important that|change of plan|change of plans|new plan|small change|one more thing|for this one|\
        from now on|as of now|second thought|scratch that|my mistake|my bad|hang on|hold on|listen|look here|alright|all right|\
        right then|better still|better yet|even better|or rather|or better|rather|this time|for a change|somehow|obviously";
    /// Words that show that a clause before "if" or "that" only wishes.
    WISHING = "would|id|itd|could|good|nice|better|great|cool|possible|grateful|prefer|wish|want|like|love|rather|hope|suppose|imagine|\
        assume|say|think|important|necessary|what|ensure|sure|see|care|arrange|happy|glad|appreciate|thankful|need|found|find|\
        fine|best|perfect|lovely|helpful|useful|obliged|ask|request|suggest|propose|demand|insist|desire|expect|require|picture|\
        pretend|provided|please|pleased|said|says|seems|turns|turned|appears|reported|reports|stated|states|claims|claimed|known|\
        true|fact|case|means|note|make";
    /// Words of `predicate.rs`.
    GONE = "gone on strike|gone on break|gone for lunch|gone on holiday|gone on their break|gone on its break|bounced|dipped|scrammed|skedaddled|cleared out|buzzed off|legged it|on break|on their break|on its break|on a break|on their breaks|on lunch break|off duty|on strike|on holiday|off site|off set|left out|left off|impounded|confiscated|seized|repossessed|decommissioned|sold|boarded|no longer there|no longer here|not there|gone|missing|away|leave|leaves|left|leaving|depart|departs|departed|departing|\
        disappear|disappears|disappeared|vanish|vanishes|vanished|drive off|drives off|drove off|driven off|drive away|\
        drives away|drove away|driven away|turned off|turns off|turned the corner|turned around the corner|turned into a side street|driven home|pull away|pulls away|pulled away|pull off|pulls off|pulled off|walk away|walks away|\
        walked away|walk off|walks off|walked off|go away|goes away|went away|go home|goes home|went home|gone home|go|goes|\
        go off|gone off|gone away|moved on|moves on|move on|moved off|moves off|move off|moved away|rides off|rode off|ride off|\
        ridden off|ridden away|rolled away|rolls away|towed away|towed|towed off|unnecessary|superfluous|redundant|unwanted|\
        obsolete|surplus|out of the scene|out of the picture|off the road|off the street|off the highway|off the motorway|off the freeway|off the carriageway|off the site|off the building site|off the construction site|off the premises|off the grounds|off the map|off the scene|off the set|off the lot|off the parking lot|off the car park|off the stage|off the screen|off the picture|off the plan|off the roadway|off the tarmac|out of here|history|cleared away|\
        cleared|taken|taken away|taken out|taken off|exit|exits|exited|clear off|clears off|withdrawn|retired|scrapped|dismissed|\
        absent|out of the way|carted off|carted away|hauled away|hauled off|removed|deleted|erased|eliminated|thrown out|\
        gotten rid of|got rid of|cut out|dropped|omitted|out|off|driven on|drives on|drove on|run off|ran off|runs off|run away|\
        ran away|runs away|no more|done here|finished here|set off|sped off|speeds off|speed off|cycled off|cycled away|\
        cycles off|hurried off|hurried away|wandered off|wanders off|been removed|been taken away|dispensed with|done away with|\
        disposed of|collected|picked up|packed up|packed away|packed in|put away|stolen|swept up|swept away|gathered up|dismantled|taken down|taken home|fetched|called away|sent away|sent home|escorted away|led away|carried away|carried off|loaded up|knocked off|called it a day|gone inside|gone indoors|gone to lunch|gone to bed|headed home|headed off|heads home|headed away|scared off|chased away|chased off|broken up|turned off the road|turned off the street|takes the next exit|took the next exit|taken the next exit|takes the exit|took the exit|taken the exit|leaves at the next exit|left at the next exit|turns off at the next exit|turned off at the next exit|takes the next turning|taken the next turning|gone round the corner|gone around the corner|goes round the corner|disappears round the corner|disappeared round the corner|disappears around the corner|disappeared around the corner|stayed at home|stayed home|stay at home|stays at home|stay home|stays home|remained at home|remain at home|not come|not turned up|called in sick|not shown up|given up|sold|bought|stolen|out of sight|out of view|no longer visible|no longer in sight|nowhere to be seen|fled|run for cover|taken shelter|taken cover|sought shelter|made off|slipped away|left the scene|cleared out|jogged off|jogged away|limped off|blown away|blown off|washed away|left the highway|left the motorway|left the freeway|left the street|left the scene|left the area|left the parking lot|left the car park|left the site|left the building site|left town|moved on to the next street|moved on to the next site|driven on to the next street|a day off|the day off|day off|off duty|off sick|on leave|on holiday|on vacation|struck|cancelled|canceled|too much|too many|one too many|gave up|run home|ran home|runs home|walked home|walks home|ridden home|rides home|cycled home|drives home|drove home|back home|back at home|home|at home|back at its station|back at the station|back at its depot|back at the depot|back in its garage|back in the garage|back at its base|back at base|back at work|in the garage|in its garage|at the depot|back at their station|dropped out|drops out|drop out|gone in|went in|went inside|goes inside|went indoors|goes indoors|gone to school|gone to work|gone on holiday|gone shopping|gone elsewhere|on his way home|on her way home|on its way home|on their way home|on the way home|on its way back|on his way back|on her way back|on their way back|out on a job|out on another job|out on an errand|out on a call|out on duty|out on a mission|out on business|out on a delivery|out on a tour|away on a job|away on business|away on an errand|out for lunch|out to lunch|out today|out for repair|out for repairs|in for repair|in for repairs|in repair|under repair|towed to the garage|in bed|at school";
    /// Places that are no part of a scene.
    OFF_SITE = "station|depot|home|hotel|hospital|house|office|school|garage|base|barracks|headquarters|yard|firehouse|stable|farm|harbour|\
        workshop|kitchen|shop|factory|camp|bed|town|city|village|hangar|warehouse|lunch|dinner|breakfast|work|quarters|canteen|club|\
        nursery|kindergarten|church|theatre|cinema|airport|port|plant|mainland|market|bakery|restaurant|cafe|pub|supermarket";
    /// What may follow one of those.
    AFTERWARDS = "from|now|already|please|too|as|again|completely|entirely|altogether|for|by|in the meantime|and|so|the scene|the road|\
        the street|the area|the place|the picture|the image|the site|us|me|home|work|instead|then|long|because|since|after|\
        anyway|off|at|with|for good|today|tonight|this|until|till|before|once|at last|finally|meanwhile";
    /// Words of `acts.rs`.
    BECOMES = "turn out to be|proves to be|prove to be|proved to be|given way to|made way for|made room for|given place to|gives way to|give way to|gave way to|has given way to|makes way for|make way for|made way for|become|becomes|became|turn into|turns into|turned into|change into|changes into|changed into|changed to|change to|\
        changes to|transformed into|transforms into|transform into|morphs into|morphed into|converted into|converted to|\
        swapped for|swapped with|swapped out for|swapped by|swapped against|exchanged for|exchanged with|exchanged by|\
        exchanged against|replaced by|replaced with|replaced for|substituted by|substituted with|substituted for|traded for|\
        switched for|switched to|switched with|made into|upgraded to|downgraded to|succeeded by|turned out to be|turns out to be|\
        make way for|makes way for|makes room for|make room for|give place to|in fact";
    /// Who is one of two.
    MATES = "mate|mates|helper|helpers|assistant|assistants|workmate|workmates|colleague|colleagues|companion|companions|partner|friend|friends|buddy|buddies|fellow|fellows|twin|pal|neighbour|\
        neighbor|coworker|workmate|workmates|comrade|comrades|counterpart";
    /// Words of `acts.rs`.
    STAYS = "stay|stays put|stay put|stands still|stand still|remains put|stays|stayed|remain|remains|remained|keep still|left as|left alone|left where|untouched|unchanged|kept|\
        keep its place|as it is|as they are|as before|fine|ok|okay|good|right where|not touched";
    /// Words of `acts.rs`.
    TURNS = "face|faces|faced|facing|look|looks|looking|point|points|pointed|pointing|turn|turns|turned|turning|rotate|rotates|\
        rotated|spin|spins|spun|swivel|swivels|headed|oriented|orientated|aimed|flipped|reversed";
    /// Ways to go that a heading follows from.
    OTHER_WAY = "the other way round|the other way around|the other way|other way|the opposite way|opposite way|in the opposite direction|\
        in the other direction|the opposite direction|the other direction|in reverse direction|the wrong way|against the traffic|\
        in opposite direction|back the way it came|the way it came";
    /// Words of `acts.rs`.
    OUR_WAY = "the same way as i do|the same way as me|the same way as us|the same way as we do|the same way i do|the same way we do|\
        the same way i am|the same way|same way as me|same way as us|same way as i do|in the same direction as i do|\
        in the same direction as me|in the same direction as us|in the same direction as we do|in the same direction|\
        the same direction as me|the same direction as us|my way|our way|in my direction|in our direction|\
        in the direction i drive|away from us like the others|same direction as me|same direction as us|same direction";
    /// Verbs after which metres and a direction are a way to go, not a place.
    MOTION = "move|moves|moved|shift|shifts|shifted|slide|slides|slid|go|goes|gone|come|comes|came|roll|rolls|rolled|drive|drives|\
        driven|drove|walk|walks|walked|step|steps|stepped|back|backs|backed|pull|pulls|pulled|push|pushed|pushes|nudge|nudged|\
        creep|creeps|advance|advances|advanced|drop|drops|dropped|fall|falls|fallen|set|put|bring|brought|take|taken|send|sent|\
        drag|dragged|reverse|reverses|edge|inch|ride|rides|ridden|swerve|displace|displaced|relocate|relocated|budge|scoot|\
        reposition|repositioned|change|changes|switch|switches|merge|merges|moving|close|closes|place|placed";
    /// Words of `swap.rs`.
    EXCHANGING = "swap|swaps|swapped|switch|switched|switches|exchange|exchanged|exchanges|trade|traded|trades|change|changed|changes|\
        interchange|interchanged|reverse|reversed|swop|swopped|flip|swapping|exchanging|switching|trading|changing";
    /// What the grammar of imperatives reads better: "likewise the vans", "all except".
    ELSEWHERE_READ = "likewise|as do|so do|so should|as should|as are|so are|as well as|and so|except|apart from|other than|nothing but|\
        everything but|all but|everyone but|everybody but";
    /// That something is there, before where.
    PRESENT = "turned up and|shown up and|arrived and|appeared and|come along and|come over and|come and|come up and|joined us and|turned up|shown up|arrived|appeared|come along|needed|wanted|required|added|be added|there|missing|in|present|put in|inserted|necessary|here|also|too|to be|joining|\
        placed|put|positioned";
    /// Imperatives that bring something elsewhere.
    MOVES = "move|shift|put|place|bring|pull|push|set|send|drive|slide|take|get|relocate|reposition|position|drag|nudge|roll|transfer|\
        displace|park|stand|steer|have|let|draw|lead|guide|switch|swing|budge|scoot|make|lay|leave|walk|back|carry|shove|\
        transport|edge|moving|putting|placing|bringing|pulling|pushing|moved|brought|pulled|pushed|placed|shifted|shifting";
    /// Beginnings of clauses that only say when or why.
    SUBORDINATE = "by the time|when|since|as|because|after|before|while|although|though|if|given that|now that|once|seeing that|even though|\
        for the sake of|to make|in order to|considering|unlike|as soon as|in case|due to|owing to|because of|for";
    /// Being there: denied, it is gone.
    THERE = "there|here|in the scene|in the picture|belong|needed|necessary|wanted|required|exist|around|anymore|any more|present|\
        appear|part of|to be seen|visible|useful|welcome|of use|in use|interesting|relevant|want|need|on the scene|at the scene|\
        in this scene|in our scene|to be there|be there|needed anymore|show|shown|seen";
    /// Beginnings of what only says why.
    REASONS = "so nothing|so nobody|so that nothing|so that nobody|so no one|so that no one|because|since|so that we|so we|so that i|so i|as it|as he|as she|as they|for safety|in order to|which is|which means|\
        so as to|to make it|or else|otherwise|to let|to avoid|for whatever|like before|as before|as usual";
    /// In the place of another.
    IN_PLACE = "there instead|on its place|on their place|on his place|on her place|on the same place|in its place|in their place|in his place|in her place|in the same place|in same place|in that place|\
        in its stead|in their stead|in his stead|in her stead|in its spot|in their spot|in the same spot|at the same place|at same place|\
        at the same spot|at the same position|at the same location|in the same position|in its position|in their position|\
        at its place|at their place|at that place|at that spot|at this place|on the same spot|on its spot|to its place|\
        to the same place|to take its place|to take their place|takes its place|take its place|takes their place|\
        take their place|takes his place|takes her place|as a replacement|as replacement|as a substitute|exactly there|\
        right there|where it was|where it stood|where it is|where they were|where they stood|where he was|where she was|\
        where he stood|where she stood|where it has been|where it had been|on the spot|into its place|into the gap|in the gap|\
        to replace it|to replace them|taken its place|taken their place|taken his place|took its place|took their place|took its spot|took their spot|takes its spot|take its spot|takes over its spot|take over its spot|take over its position|takes over its position|take over its place|takes over its place|takes its position|take its position|taken over its place|taken its spot|has its place now|same place|\
        same spot|same position|same location";
    /// What follows is where it ends.
    UNTIL = "until it is|until its|until they are|until he is|until she is|until it stands|until it reaches|until hes|until shes|\
        until theyre|until|till it is|till|so that it is|so that its|so that it stands|so that they are|so that they stand|\
        so that he is|so that she is|so that it|so it is|so its|so that they|so that he|so that she|up to";
}
