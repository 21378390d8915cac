//! Copies of unsaved work: while there are unsaved changes, the scene is written into the program's state folder every
//! half minute, on a thread of its own, whole or not at all. Copies from a process that died are offered at the next
//! start.
//!
//! Each session has a folder `recovery/<time>-<process>` with `scene.loom`, `about.json` and `lock`. The operating
//! system holds the lock as long as the process lives, so a process that can take the lock knows that the session is
//! over.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crossbeam_channel::{Receiver, Sender, unbounded};
use serde::{Deserialize, Serialize};

use editor::Document;
use formats::{atomic, input, loom};
use language::{t, tf};
use runtime::guard::{Handed, guarded};
use scene::{Scene, SceneRev};

/// Time between two copies, s.
pub const EVERY_S: f64 = 30.0;
/// Age from which a folder without a scene is treated as left over and removed.
const EMPTY_AFTER: Duration = Duration::from_secs(60);

/// Name of the thread.
const NAME: &str = "recovery";

const SCENE: &str = "scene.loom";
const ABOUT: &str = "about.json";
const LOCK: &str = "lock";

/// Metadata kept beside the scene.
#[derive(Serialize, Deserialize)]
struct RecoveryRecord {
    /// The file that the scene came from or was saved to.
    original: Option<PathBuf>,
    /// Name of the scene.
    name: String,
    /// Time of the copy, seconds since 1970.
    saved_unix_s: u64,
}

enum Job {
    Write(Box<Scene>, Option<PathBuf>),
    Remove,
}

/// The copies of one session.
pub struct Recovery {
    folder: PathBuf,
    lock: Option<File>, // `None` only while dropping
    every_s: f64,
    jobs: Option<Sender<Handed<Job>>>, // `None` only while dropping
    done: Receiver<Result<(), String>>,
    thread: Option<JoinHandle<()>>,
    asked: Option<SceneRev>,
    last_s: f64,
    writing: bool,
    on_disk: bool,
    failed: bool,
    unsaved: bool,
    forgotten: bool,
    /// Copies from sessions that died, which the user has not answered about, newest first.
    pub offers: Vec<Stale>,
    pub(crate) opening: Option<Stale>,
    pub(crate) replaced: Vec<Stale>,
}

/// Folder of the copies: `$SCENELOOM_STATE_DIR/recovery`, else in the user's state folder.
pub fn root() -> Option<PathBuf> {
    super::folders::state().map(|folder| folder.join("recovery"))
}

impl Recovery {
    /// Starts the session of this process in the user's folder, with the offers of sessions that died. Errors if the
    /// folder cannot be written. `SCENELOOM_AUTOSAVE_S` replaces the half minute.
    pub fn at_start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let root =
            root().ok_or_else(|| std::io::Error::other("the system names no folder for program state"))?;
        let asked: Option<f64> = std::env::var("SCENELOOM_AUTOSAVE_S")
            .ok()
            .and_then(|v| v.parse().ok());
        let every_s = asked.filter(|s| s.is_finite() && *s > 0.0).unwrap_or(EVERY_S);
        Self::start(&root, every_s, wake)
    }

    /// Starts a session in a given folder, with a given time between copies, s. `wake` is called after each copy.
    pub fn start(root: &Path, every_s: f64, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let offers = stale(root);
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let folder = root.join(format!("{}-{}", since.as_micros(), std::process::id()));
        fs::create_dir_all(&folder)?;
        let lock = File::create(folder.join(LOCK))?;
        lock.lock()?;
        let (jobs, jobs_in) = unbounded::<Handed<Job>>();
        let (done_out, done) = unbounded();
        let place = folder.clone();
        let thread = std::thread::Builder::new().name(NAME.into()).spawn(move || {
            for job in jobs_in {
                let is_copy = matches!(job.request(), Job::Write(..));
                let done = job.run(|job| match job {
                    Job::Write(scene, original) => write(&place, &scene, original),
                    Job::Remove => {
                        remove_copy(&place);
                        Ok(())
                    }
                });
                let done = done
                    .unwrap_or_else(|panic| Err(panic.into()))
                    .map_err(|e| e.to_string());
                if is_copy {
                    // The receiver lives as long as the thread, except at the very end.
                    let _ = done_out.send(done);
                    // A wake-up that panics must not end the thread.
                    let _ = guarded(NAME, &wake);
                }
            }
        })?;
        Ok(Self {
            folder,
            lock: Some(lock),
            every_s,
            jobs: Some(jobs),
            done,
            thread: Some(thread),
            asked: None,
            last_s: f64::NEG_INFINITY,
            writing: false,
            on_disk: false,
            failed: false,
            unsaved: false,
            forgotten: false,
            offers,
            opening: None,
            replaced: Vec::new(),
        })
    }

    /// Writes a copy if there are unsaved changes that no copy has and it is time; removes the copy if there are no
    /// unsaved changes. Returns the seconds after which to call it again if no other event comes, and the reason why a
    /// copy could not be written (reported once, until writing works again). `with_kept` adds the data that the scene's
    /// file keeps beside it. `now_s` never runs backward.
    pub fn tick(
        &mut self,
        document: &Document,
        path: Option<&Path>,
        with_kept: impl FnOnce(&Scene) -> Scene,
        now_s: f64,
    ) -> (Option<f64>, Option<String>) {
        let mut problem = None;
        while let Ok(done) = self.done.try_recv() {
            problem = self.note(done).or(problem);
        }
        let scene = document.settled_scene();
        self.unsaved = document.is_dirty();
        if !self.unsaved {
            self.asked = None;
            self.last_s = f64::NEG_INFINITY;
            if self.on_disk || self.writing {
                self.on_disk = false;
                self.send(Job::Remove);
            }
            // The recovered scene has been saved by now.
            self.replaced.drain(..).for_each(Stale::discard);
            return (None, problem);
        }
        if self.asked == Some(scene.content()) || self.writing {
            return (None, problem);
        }
        let due_s = self.last_s + self.every_s;
        if now_s < due_s {
            return (Some(due_s - now_s), problem);
        }
        (self.asked, self.last_s, self.writing) = (Some(scene.content()), now_s, true);
        self.send(Job::Write(
            Box::new(with_kept(scene)),
            path.map(Path::to_path_buf),
        ));
        (None, problem)
    }

    /// Waits until the running copy is written.
    pub fn wait(&mut self) {
        while self.writing {
            match self.done.recv() {
                Ok(done) => drop(self.note(done)),
                Err(_) => self.writing = false,
            }
        }
    }

    /// Notes that the user discards the unsaved changes: no copy is left at the end.
    pub fn forget(&mut self) {
        self.forgotten = true;
    }

    fn note(&mut self, done: Result<(), String>) -> Option<String> {
        self.writing = false;
        match done {
            Ok(()) => {
                self.failed = false;
                if self.unsaved {
                    self.on_disk = true;
                    // The new copy contains the recovered scene.
                    self.replaced.drain(..).for_each(Stale::discard);
                }
                None
            }
            Err(problem) => {
                self.asked = None; // to be written again when it is time
                (!std::mem::replace(&mut self.failed, true)).then_some(problem)
            }
        }
    }

    fn send(&self, job: Job) {
        if let Some(jobs) = &self.jobs {
            // The thread ends only when this sender is dropped.
            let _ = jobs.send(Handed::new(NAME, job));
        }
    }
}

impl Drop for Recovery {
    /// Keeps the copy if there are changes that the user has neither saved nor discarded.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // An error would be a panic in the thread, and the session is ending.
            let _ = thread.join();
        }
        self.lock = None;
        if self.forgotten || !self.unsaved {
            self.replaced.drain(..).for_each(Stale::discard);
            // A folder that cannot be removed is removed at a later start.
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

fn write(folder: &Path, scene: &Scene, original: Option<PathBuf>) -> anyhow::Result<()> {
    loom::save(&folder.join(SCENE), scene)?;
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let about = RecoveryRecord {
        original,
        name: scene.name.to_string(),
        saved_unix_s: since.as_secs(),
    };
    atomic::write(&folder.join(ABOUT), &serde_json::to_vec(&about)?)?;
    Ok(())
}

fn remove_copy(folder: &Path) {
    // A copy that cannot be removed is offered at the next start, which is better than a lost one.
    let _ = fs::remove_file(folder.join(SCENE));
    let _ = fs::remove_file(folder.join(ABOUT));
}

/// A copy from a session that died. While this value lives, no other process offers it.
#[derive(Debug)]
pub struct Stale {
    folder: PathBuf,
    lock: Option<File>,
    /// The file that the scene came from, if any.
    pub original: Option<PathBuf>,
    /// Name of the scene.
    pub name: String,
    /// Time at which the copy was written.
    pub saved: SystemTime,
}

impl Stale {
    /// Path of the copy.
    pub fn file(&self) -> PathBuf {
        self.folder.join(SCENE)
    }

    /// Removes the copy permanently.
    pub fn discard(mut self) {
        self.lock = None;
        // A copy that cannot be removed is offered again.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Copies from dead sessions in a folder, newest first. Leftovers without a scene are removed.
pub fn stale(root: &Path) -> Vec<Stale> {
    let Ok(entries) = fs::read_dir(root) else {
        return Vec::new(); // the first session has no folder
    };
    let mut found: Vec<Stale> = entries
        .flatten()
        .filter(|e| e.file_type().is_ok_and(|t| t.is_dir()))
        .filter_map(|e| dead_session(e.path()))
        .collect();
    found.sort_by(|a, b| (b.saved, &b.folder).cmp(&(a.saved, &a.folder)));
    found
}

fn dead_session(folder: PathBuf) -> Option<Stale> {
    let lock = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(folder.join(LOCK))
        .ok()?;
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return None, // its process is alive
        Err(TryLockError::Error(_)) => return None,   // the state of the session is unknown
    }
    let scene = fs::metadata(folder.join(SCENE)).and_then(|m| m.modified());
    let Ok(modified) = scene else {
        let age = fs::metadata(&folder)
            .and_then(|m| m.modified())
            .ok()
            .and_then(|t| t.elapsed().ok());
        drop(lock);
        // A session that has just begun is not locked yet.
        if age.is_some_and(|age| age > EMPTY_AFTER) {
            let _ = fs::remove_dir_all(&folder);
        }
        return None;
    };
    let about: Option<RecoveryRecord> = input::read(&folder.join(ABOUT), input::LARGEST_TEXT)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let (original, name) = about.map_or((None, t("a scene").into()), |a| (a.original, a.name));
    Some(Stale {
        folder,
        lock: Some(lock),
        original,
        name,
        saved: modified,
    })
}

/// A duration as text, for example `12 minutes ago`.
pub fn ago(since: Duration) -> String {
    match since.as_secs() {
        1 => t("1 second ago").into(),
        s @ 0..=89 => tf!("{n} seconds ago", n = s),
        s @ 90..=5399 => tf!("{n} minutes ago", n = (s + 30) / 60),
        s @ 5400..=129_599 => tf!("{n} hours ago", n = (s + 1800) / 3600),
        s => tf!("{n} days ago", n = s.saturating_add(43_200) / 86_400),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;
    use editor::Edit;

    fn document() -> Document {
        Document::new(open::bundled().expect("bundled"))
    }

    fn say(document: &mut Document, prompt: &str) {
        let prompt = prompt.to_owned();
        document
            .apply("Prompt", &Edit::SetPrompt { prompt })
            .expect("always");
    }

    fn prompt_in(file: &Path) -> String {
        loom::load(file).expect("a whole scene").prompt.to_string()
    }

    #[test]
    fn copies_come_at_once_then_at_intervals_and_go_when_saved() {
        let root = tempfile::tempdir().expect("a folder");
        let mut recovery = Recovery::start(root.path(), 30.0, || {}).expect("a session");
        let (mut document, copy) = (document(), recovery.folder.join(SCENE));
        assert_eq!(recovery.tick(&document, None, Scene::clone, 0.0), (None, None));
        assert!(!copy.exists());
        say(&mut document, "one");
        assert_eq!(recovery.tick(&document, None, Scene::clone, 1.0), (None, None));
        recovery.wait();
        assert_eq!(prompt_in(&copy), "one");
        say(&mut document, "two");
        assert_eq!(
            recovery.tick(&document, None, Scene::clone, 11.0),
            (Some(20.0), None)
        );
        recovery.wait();
        assert_eq!(prompt_in(&copy), "one");
        assert_eq!(recovery.tick(&document, None, Scene::clone, 31.0), (None, None));
        recovery.wait();
        assert_eq!(prompt_in(&copy), "two");
        assert_eq!(
            recovery.tick(&document, None, Scene::clone, 99.0),
            (None, None),
            "nothing new"
        );
        document.mark_saved();
        recovery.tick(&document, None, Scene::clone, 100.0);
        drop(recovery);
        assert_eq!(fs::read_dir(root.path()).expect("there").count(), 0);
    }

    #[test]
    fn unsaved_work_outlives_the_session_and_is_offered_once() {
        let root = tempfile::tempdir().expect("a folder");
        let start = || Recovery::start(root.path(), 30.0, || {}).expect("a session");
        let mut first = start();
        let mut document = document();
        say(&mut document, "night");
        first.tick(&document, Some(Path::new("/tmp/a.loom")), Scene::clone, 0.0);
        first.wait();
        let mut second = start();
        assert_eq!(second.offers.len(), 0, "the first one lives");
        drop(first); // like after a crash of the window system: neither saved nor discarded
        let mut third = start();
        assert_eq!(third.offers.len(), 1);
        assert_eq!(start().offers.len(), 0, "offered to one process only");
        let offer = third.offers.remove(0);
        assert_eq!(
            (offer.original.as_deref(), &*offer.name),
            (Some(Path::new("/tmp/a.loom")), &*document.scene().name)
        );
        assert_eq!(prompt_in(&offer.file()), "night");
        drop(offer); // answer later
        let offer = start().offers.remove(0);
        offer.discard();
        assert_eq!(start().offers.len(), 0);
        // Discarded changes leave no copy.
        second.tick(&document, None, Scene::clone, 0.0);
        second.wait();
        second.forget();
        drop((second, third));
        assert_eq!(fs::read_dir(root.path()).expect("there").count(), 0);
    }

    #[test]
    fn a_folder_that_vanishes_is_told_once() {
        let root = tempfile::tempdir().expect("a folder");
        let mut recovery = Recovery::start(root.path(), 1.0, || {}).expect("a session");
        let mut document = document();
        fs::remove_dir_all(&recovery.folder).expect("removed");
        let mut told = Vec::new();
        for i in 0..3 {
            say(&mut document, &i.to_string());
            recovery.tick(&document, None, Scene::clone, f64::from(i) * 10.0);
            // Not `wait`, which would drop the problem.
            let done = recovery.done.recv().expect("an answer");
            told.extend(recovery.note(done));
        }
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(!told[0].contains('\n'));
    }

    #[test]
    fn a_panic_is_told_and_the_next_copy_is_written() {
        let root = tempfile::tempdir().expect("a folder");
        let mut recovery = Recovery::start(root.path(), 1.0, || panic!("a wake-up")).expect("a session");
        let (mut document, copy) = (document(), recovery.folder.join(SCENE));
        say(&mut document, "one");
        runtime::guard::panic_next(NAME);
        recovery.tick(&document, None, Scene::clone, 0.0);
        let done = recovery.done.recv().expect("an answer");
        let told = recovery.note(done);
        assert_eq!(told.as_deref(), Some("recovery panicked: asked for by a test"));
        assert!(!copy.exists());
        recovery.tick(&document, None, Scene::clone, 10.0);
        let done = recovery.done.recv().expect("an answer");
        assert_eq!((done.clone(), recovery.note(done)), (Ok(()), None));
        assert_eq!(prompt_in(&copy), "one");
    }

    #[test]
    fn ages_are_readable() {
        let text = |s| ago(Duration::from_secs(s));
        assert_eq!(text(1), "1 second ago");
        assert_eq!(text(720), "12 minutes ago");
        assert_eq!(text(7200), "2 hours ago");
        assert_eq!(text(200_000), "2 days ago");
    }
}
