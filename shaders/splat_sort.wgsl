// A stable radix sort by four bits a pass, without subgroups: digits are counted per block of items,
// the counts are summed over all blocks, digit by digit, and each block moves its items there.
// What has the key CULLED is left out.

const THREADS: u32 = 128u;
const PER_THREAD: u32 = 8u;
const BLOCK: u32 = THREADS * PER_THREAD;
const DIGITS: u32 = 16u;

struct Pass {
    // Lowest bit of the digit.
    shift: u32,
    // For the scan: sums per block of items, items per block, and what there is room for.
    rows: u32,
    block: u32,
    room: u32,
}

@group(0) @binding(1) var<uniform> settings: Pass;
@group(0) @binding(2) var<storage, read_write> ledger: Ledger;
@group(0) @binding(3) var<storage, read> items: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> sorted: array<vec2<u32>>;

var<workgroup> items_there: u32;
var<workgroup> digits: array<atomic<u32>, DIGITS>;
var<workgroup> counts: array<u32, 2048>; // [digit][thread]
var<workgroup> bases: array<u32, DIGITS>;
var<workgroup> partial: array<u32, 256>;

fn digit_of(key: u32) -> u32 {
    return (key >> settings.shift) & (DIGITS - 1u);
}

@compute @workgroup_size(128)
fn count_digits(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        items_there = ledger.count;
    }
    if thread < DIGITS {
        atomicStore(&digits[thread], 0u);
    }
    let n = workgroupUniformLoad(&items_there);
    let start = group.x * BLOCK;
    if start >= n {
        return;
    }
    for (var k = 0u; k < PER_THREAD; k++) {
        let i = start + k * THREADS + thread;
        if i < n {
            let key = items[i].x;
            if key != CULLED {
                atomicAdd(&digits[digit_of(key)], 1u);
            }
        }
    }
    workgroupBarrier();
    if thread < DIGITS {
        let blocks = (n + BLOCK - 1u) / BLOCK;
        ledger.sums[thread * blocks + group.x] = atomicLoad(&digits[thread]);
    }
}

// Stops at the largest number: there can be more touches than that, which is then an error.
fn plus(a: u32, b: u32) -> u32 {
    return a + min(b, 0xffffffffu - a);
}

// One workgroup: each sum becomes that of all before it.
@compute @workgroup_size(256)
fn scan(@builtin(local_invocation_index) thread: u32) {
    let n = ledger.count;
    let length = settings.rows * ((n + settings.block - 1u) / settings.block);
    let share = (length + 255u) / 256u;
    let first = min(thread * share, length);
    let end = min(first + share, length);
    var sum = 0u;
    for (var i = first; i < end; i++) {
        sum = plus(sum, ledger.sums[i]);
    }
    partial[thread] = sum;
    workgroupBarrier();
    for (var step = 1u; step < 256u; step *= 2u) {
        var before = 0u;
        if thread >= step {
            before = partial[thread - step];
        }
        workgroupBarrier();
        partial[thread] = plus(partial[thread], before);
        workgroupBarrier();
    }
    var running = partial[thread] - sum;
    for (var i = first; i < end; i++) {
        let here = ledger.sums[i];
        ledger.sums[i] = running;
        running += here;
    }
    if thread == 255u {
        ledger.before = n;
        if settings.rows == 1u {
            ledger.touches = partial[255];
        }
        ledger.count = min(partial[255], settings.room);
    }
}

@compute @workgroup_size(128)
fn scatter(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        items_there = ledger.before;
    }
    let n = workgroupUniformLoad(&items_there);
    let start = group.x * BLOCK;
    if start >= n {
        return;
    }
    for (var digit = 0u; digit < DIGITS; digit++) {
        counts[digit * THREADS + thread] = 0u;
    }
    // A thread's items lie side by side, so that threads in order are items in order.
    let first = start + thread * PER_THREAD;
    let end = min(first + PER_THREAD, n);
    for (var i = first; i < end; i++) {
        let key = items[i].x;
        if key != CULLED {
            counts[digit_of(key) * THREADS + thread] += 1u;
        }
    }
    workgroupBarrier();
    var sum = 0u;
    for (var k = 0u; k < DIGITS; k++) {
        sum += counts[thread * DIGITS + k];
    }
    partial[thread] = sum;
    workgroupBarrier();
    for (var step = 1u; step < THREADS; step *= 2u) {
        var before = 0u;
        if thread >= step {
            before = partial[thread - step];
        }
        workgroupBarrier();
        partial[thread] += before;
        workgroupBarrier();
    }
    var running = partial[thread] - sum;
    for (var k = 0u; k < DIGITS; k++) {
        let here = counts[thread * DIGITS + k];
        counts[thread * DIGITS + k] = running;
        running += here;
    }
    workgroupBarrier();
    if thread < DIGITS {
        let blocks = (n + BLOCK - 1u) / BLOCK;
        bases[thread] = ledger.sums[thread * blocks + group.x] - counts[thread * THREADS];
    }
    workgroupBarrier();
    for (var i = first; i < end; i++) {
        let item = items[i];
        if item.x != CULLED {
            let digit = digit_of(item.x);
            let slot = digit * THREADS + thread;
            sorted[bases[digit] + counts[slot]] = item;
            counts[slot] += 1u;
        }
    }
}
