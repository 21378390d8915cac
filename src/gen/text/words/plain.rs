//! English words that the lexicon does not know and that are no slips of the pen: "better" is no "beater".

/// Such words of five letters or more, apart by a space.
pub const PLAIN: &str = "\
    abled abused abuses again against analysis angles another asserted because before better between blanks bother \
    bothers bounded bounding braced braces breaking bricks cameras carries cased casing casting casts causes \
    center centered centers challenges chapter clearer coding combine combined combos computed computer computers \
    constructions consumes converge converged converges converted converting copes costs coupled crashes cruiser \
    crunch darling derive derived derives deriving director directory divides dozens drafts dropping edited \
    editing elected existed existing falling figured files filler fixes former framer freeing garbage gating \
    grants guess guided guides heading headings hundreds later layer layers leader leaders leaked learned learning \
    learns likely liner linked linker linking living locking logged losses making managers manages marking \
    markings masking matched matcher matches maybe missed moral multiples neighborhoods packaged packet packets \
    paddle pagers paging papers pasted pastes patent patents paying payment picked placing planar planned plans \
    plots pointer pointers pools popped printer proceedings processor processors project projected projects \
    quarters raised ranged ranges ranging rating reader readers resets retained retaining retains reverted \
    reverting rising saying scaled scaling scanned scanning scores scream screaming scroll scrolled scrolling \
    seeding seeds sensor sensors serve served serves serving shared shares sharing sheets shipped shipping sides \
    sifting signer sleeping slices slicing slipped slipping snowball solver sooner spaces spare spawned spawning \
    spending spinning splitting squared stacking staged staging starred stars started starting state statics \
    statue statues status stealing store stored storing story strand string strips strive stroke strong stronger \
    subset suffer summary swagger tagged tagging taking target teaches thinks thins thorough thousands threads \
    threats tiled touches traced traces tracing trades trained training traits transmit traps trial trials tricked \
    tries triple triples tuned tuning wanted wanting wasted wasting water window winner wonder wording worse \
    writer writers writing";
