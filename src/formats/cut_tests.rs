//! Every reader of the table, with files that are cut off or lie: no panic, one line, and no more memory than twice the file
//! beside what a scene takes.

#[path = "../../tests/it/peak_memory.rs"]
mod peak_memory;

use std::process::Command;

use peak_memory::peak_growth;

use crate::import::{self, Importer};
use crate::table_tests::refusal;

const MIB: usize = 1 << 20;
/// What a scene takes whatever is in its file (labels, layout, what is inferred from them), and the allocator.
const OWN: usize = 48 * MIB;

/// Samples up to this long are cut at every byte, longer ones at this many places and everywhere near their ends.
const SMALL: usize = 4096;

/// Where a sample is cut.
fn cuts(length: usize) -> Vec<usize> {
    let spread = (0..SMALL).map(|i| i * length / SMALL);
    let mut cuts: Vec<usize> = match length <= SMALL {
        true => (0..length).collect(),
        false => (0..256).chain(spread).chain(length - 256..length).collect(),
    };
    cuts.sort_unstable();
    cuts.dedup();
    cuts
}

fn cut_everywhere(importer: &'static Importer) {
    let sample = (importer.sample)();
    for cut in cuts(sample.len()) {
        // Some formats have no end of their own: then what is left is read.
        refusal(importer, &sample[..cut]);
    }
}

#[test]
fn files_cut_at_every_byte_are_one_line_or_read() {
    let all = import::all();
    std::thread::scope(|scope| {
        for part in 0..2 {
            scope.spawn(move || all.iter().skip(part).step_by(2).for_each(|i| cut_everywhere(i)));
        }
    });
}

/// The sample with huge numbers where it has others: words of four and eight bytes in the head of a binary file, digits in
/// a text.
fn lies(sample: &[u8]) -> Vec<Vec<u8>> {
    let mut out = Vec::new();
    let patterns: [&[u8]; 4] = [
        &[0xff; 4],
        &[0xff, 0xff, 0xff, 0x7f],
        &[0xff; 8],
        &[0, 0, 0, 0, 1, 0, 0, 0], // 4 GiB
    ];
    let (near, far) = if sample.len() > MIB { (20, 20) } else { (2, 6) };
    let places = (0..100).step_by(near).chain((100..400).step_by(far));
    for at in places.take_while(|at| *at < sample.len()) {
        for pattern in patterns {
            let mut lie = sample.to_vec();
            let end = (at + pattern.len()).min(lie.len());
            lie[at..end].copy_from_slice(&pattern[..end - at]);
            out.push(lie);
        }
    }
    if let Ok(text) = std::str::from_utf8(sample) {
        let mut at = 0;
        while let Some(from) = text[at..].find(|c: char| c.is_ascii_digit()).map(|i| at + i)
            && out.len() < 600
        {
            let digits = text[from..].bytes().take_while(u8::is_ascii_digit).count();
            for number in ["4294967296", "1e308", "-1", "\"x\"", "NaN"] {
                out.push(
                    [&text[..from], number, &text[from + digits..]]
                        .concat()
                        .into_bytes(),
                );
            }
            at = from + digits;
        }
    }
    out
}

/// Row 62 of the extremes table for every reader. The peak of the process is read, so the test runs itself again alone.
#[test]
fn row_62_lies_take_no_memory() {
    let alone = Command::new(std::env::current_exe().expect("this test program"))
        .args(["--exact", "cut_tests::row_62_alone", "--ignored", "--nocapture"])
        .output()
        .expect("a process");
    let text = String::from_utf8_lossy(&alone.stdout);
    println!("{text}");
    let errors = String::from_utf8_lossy(&alone.stderr);
    assert!(alone.status.success() && text.contains("1 passed"), "{errors}");
}

#[test]
#[ignore = "row_62_lies_take_no_memory runs it in a process of its own"]
fn row_62_alone() {
    for importer in import::all() {
        let sample = (importer.sample)();
        refusal(importer, &sample); // what is made once is made now
        let lies = lies(&sample);
        let Some(grown) = peak_growth(|| {
            for lie in &lies {
                refusal(importer, lie);
            }
        }) else {
            return println!("this system does not tell a process's peak memory");
        };
        println!(
            "{}: {} lies of {:.3} MiB, peak {:.1} MiB",
            importer.id,
            lies.len(),
            sample.len() as f64 / MIB as f64,
            grown as f64 / MIB as f64
        );
        assert!(
            grown <= 2 * sample.len() + OWN,
            "{}: {} MiB",
            importer.id,
            grown / MIB
        );
    }
}
