//! Peak memory of a process, as Linux tells it; tests of several rooms read it.

/// Peak of this process's memory beyond where it stood, while `work` runs; `None` where the system does not tell.
pub fn peak_growth(work: impl FnOnce()) -> Option<usize> {
    let field = |name: &str| -> Option<usize> {
        let text = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = text.lines().find(|l| l.starts_with(name))?;
        Some(line.split_whitespace().nth(1)?.parse::<usize>().ok()? * 1024)
    };
    // 5 sets the peak back to what is held now.
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    let before = field("VmRSS:")?;
    work();
    Some(field("VmHWM:")?.saturating_sub(before))
}
