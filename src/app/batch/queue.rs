//! Queue of batches. One batch runs at a time, the most urgent first. A batch that was stopped goes on from the files
//! it has written.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam_channel::{Receiver, Sender, unbounded};

use super::marks::Marks;
use super::plan::BatchPlan;
use super::run::{Batch, BatchProgress, BatchReport, Shard, claim};

/// How urgent a batch is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Priority {
    /// After the others.
    Low,
    /// In the order in which they were added.
    #[default]
    Normal,
    /// Before the others: the batch that runs stops after its current variant.
    High,
}

impl Priority {
    /// All of them, the most urgent first.
    pub const ALL: [Self; 3] = [Self::High, Self::Normal, Self::Low];

    /// Name shown to the user.
    pub fn label(self) -> &'static str {
        match self {
            Self::Low => "Low",
            Self::Normal => "Normal",
            Self::High => "High",
        }
    }
}

/// State of a batch.
#[derive(Clone, Debug, PartialEq)]
pub enum BatchState {
    /// Waits for its turn.
    Waiting,
    /// Runs on the thread.
    Running,
    /// Paused until it is resumed.
    Paused,
    /// All variants are ready or failed.
    Done(BatchReport),
    /// The batch cannot be run.
    Failed(String),
}

/// A batch of the queue.
pub struct Item {
    /// Id that tells it from the others.
    pub id: u64,
    /// Name of its folder.
    pub name: String,
    /// Plan of the batch.
    pub plan: BatchPlan,
    /// Output folder.
    pub output: PathBuf,
    /// How urgent it is.
    pub priority: Priority,
    /// Its state.
    pub state: BatchState,
    /// Number of variants that are ready or failed.
    pub done: usize,
    /// Variants that failed, with the reason of each.
    pub failed: Vec<(usize, String)>,
    /// Stars and discarded variants.
    pub marks: Marks,
    /// True while the index lacks the newest marks.
    is_index_old: bool,
    /// The folder to which the plan's paths are relative.
    folder: PathBuf,
}

impl Item {
    /// The batch, ready to run.
    pub fn batch(&self) -> anyhow::Result<Batch> {
        Batch::new(self.plan.clone(), &self.folder, &self.output)
    }
}

enum BatchEvent {
    At(BatchProgress),
    Ended(anyhow::Result<BatchReport>),
}

struct RunningBatch {
    id: u64,
    stop: Arc<AtomicBool>,
    news: Receiver<BatchEvent>,
    /// True if the run only writes the index again.
    is_index: bool,
}

/// The queue. When it is dropped, it stops after the current variant.
#[derive(Default)]
pub struct Queue {
    items: Vec<Item>,
    running: Option<RunningBatch>,
    next_id: u64,
}

impl Queue {
    /// All batches, in the order in which they were added.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The batch of an id.
    pub fn item(&self, id: u64) -> Option<&Item> {
        self.items.iter().find(|i| i.id == id)
    }

    fn item_mut(&mut self, id: u64) -> Option<&mut Item> {
        self.items.iter_mut().find(|i| i.id == id)
    }

    /// Adds a batch at the end. `folder` is the folder of the plan. Errors if the output folder belongs to another
    /// plan, cannot be written, or is in the queue already.
    pub fn add(&mut self, plan: BatchPlan, folder: &Path, output: &Path) -> anyhow::Result<u64> {
        if let Some(problem) = plan.problem() {
            anyhow::bail!("{problem}");
        }
        if let Some(there) = self.items.iter().find(|i| i.output == output) {
            anyhow::bail!("{} is in the queue already", there.name);
        }
        claim(&plan, output)?;
        let id = self.next_id;
        self.next_id += 1;
        let name = output.file_name().unwrap_or(output.as_os_str());
        self.items.push(Item {
            id,
            name: name.to_string_lossy().into_owned(),
            marks: Marks::read(output)?,
            plan,
            output: output.into(),
            priority: Priority::default(),
            state: BatchState::Waiting,
            done: 0,
            failed: Vec::new(),
            is_index_old: false,
            folder: folder.into(),
        });
        Ok(id)
    }

    /// Removes a batch from the queue; its files stay.
    pub fn remove(&mut self, id: u64) {
        self.stop(id);
        self.items.retain(|i| i.id != id);
    }

    /// Makes a batch more or less urgent.
    pub fn set_priority(&mut self, id: u64, priority: Priority) {
        if let Some(item) = self.item_mut(id) {
            item.priority = priority;
        }
    }

    /// The batch that runs after the current one: of the most urgent that wait, the first.
    pub fn next_up(&self) -> Option<u64> {
        let waiting = self.items.iter().filter(|i| i.state == BatchState::Waiting);
        // `max_by_key` takes the last of equals: searched from the back, that is the first of the queue.
        waiting.rev().max_by_key(|i| i.priority).map(|i| i.id)
    }

    /// Moves a waiting batch before all others that wait. The batch that runs goes on.
    pub fn run_next(&mut self, id: u64) {
        let waits = |i: &&Item| i.state == BatchState::Waiting;
        let most = self.items.iter().filter(waits).map(|i| i.priority).max();
        let at = self.items.iter().position(|i| i.id == id && waits(&i));
        if let (Some(at), Some(most)) = (at, most) {
            let item = Item {
                priority: most,
                ..self.items.remove(at)
            };
            self.items.insert(0, item);
        }
    }

    /// Stops a batch after its current variant until it is resumed.
    pub fn pause(&mut self, id: u64) {
        self.stop(id);
        if let Some(item) = self.item_mut(id)
            && matches!(item.state, BatchState::Waiting | BatchState::Running)
        {
            item.state = BatchState::Paused;
        }
    }

    /// Lets a batch wait for its turn again. A batch that failed, or that has failed variants, is tried again.
    pub fn resume(&mut self, id: u64) {
        let runs = self.running.as_ref().is_some_and(|r| r.id == id);
        if let Some(item) = self.item_mut(id)
            && (!runs || item.state == BatchState::Paused)
        {
            item.state = BatchState::Waiting;
        }
    }

    /// Changes the marks of a batch and writes them. Errors if they cannot be written.
    pub fn mark(&mut self, id: u64, change: impl FnOnce(&mut Marks)) -> anyhow::Result<()> {
        let Some(item) = self.item_mut(id) else {
            return Ok(());
        };
        change(&mut item.marks);
        item.is_index_old = true;
        item.marks.write(&item.output)
    }

    fn stop(&self, id: u64) {
        if let Some(running) = self.running.as_ref().filter(|r| r.id == id) {
            running.stop.store(true, Ordering::Relaxed);
        }
    }

    /// Takes news from the thread and starts the next batch. The thread calls `wake` when there is more. Returns the
    /// batches that ended.
    pub fn tick(&mut self, wake: impl Fn() + Clone + Send + 'static) -> Vec<u64> {
        let ended = self.take_news();
        match &self.running {
            None => self.start_next(wake),
            Some(running) => {
                let urgent = |i: &Item| i.state == BatchState::Waiting && i.id != running.id;
                let most = self.items.iter().filter(|i| urgent(i)).map(|i| i.priority).max();
                let own = self.item(running.id).map(|i| i.priority);
                if most > own {
                    running.stop.store(true, Ordering::Relaxed);
                }
            }
        }
        ended
    }

    fn take_news(&mut self) -> Vec<u64> {
        let mut ended = Vec::new();
        let Some(running) = self.running.take() else {
            return ended;
        };
        let (id, is_index) = (running.id, running.is_index);
        let mut is_over = false;
        for news in running.news.try_iter().collect::<Vec<_>>() {
            let Some(item) = self.item_mut(id) else {
                is_over |= matches!(news, BatchEvent::Ended(_));
                continue; // the batch was taken out of the queue
            };
            match news {
                BatchEvent::At(progress) => {
                    item.done = progress.done;
                    item.failed
                        .extend(progress.failed.map(|why| (progress.variant, why)));
                }
                BatchEvent::Ended(result) => {
                    is_over = true;
                    let paused = item.state == BatchState::Paused;
                    item.state = match result {
                        Ok(report) if report.open == 0 => BatchState::Done(report),
                        Ok(_) if paused => BatchState::Paused,
                        Ok(_) => BatchState::Waiting,
                        Err(error) => BatchState::Failed(scene::message::of_error(error.as_ref())),
                    };
                    if !is_index && !matches!(item.state, BatchState::Waiting | BatchState::Paused) {
                        ended.push(id);
                    }
                }
            }
        }
        if !is_over {
            self.running = Some(running);
        }
        ended
    }

    fn start_next(&mut self, wake: impl Fn() + Clone + Send + 'static) {
        let next = self.next_up();
        let is_index = next.is_none();
        let old = |i: &&mut Item| i.is_index_old && matches!(i.state, BatchState::Done(_));
        let Some(item) = (match next {
            Some(id) => self.item_mut(id),
            None => self.items.iter_mut().find(old),
        }) else {
            return;
        };
        if !is_index {
            (item.state, item.done) = (BatchState::Running, 0);
            item.failed.clear();
        }
        item.is_index_old = false;
        let (news, stop) = (unbounded(), Arc::new(AtomicBool::new(false)));
        let (tell, told): (Sender<BatchEvent>, _) = news;
        let (plan, folder, output) = (item.plan.clone(), item.folder.clone(), item.output.clone());
        let id = item.id;
        let (stopped, progress, wake_up) = (stop.clone(), tell.clone(), wake.clone());
        let work = move || {
            Batch::new(plan, &folder, &output)?.run(Shard::default(), &mut |at| {
                // Sending fails if the window has closed.
                let _ = progress.send(BatchEvent::At(at.clone()));
                wake_up();
                !stopped.load(Ordering::Relaxed)
            })
        };
        let thread = runtime::guard::spawn("batch", work, move |result| {
            let _ = tell.send(BatchEvent::Ended(
                result.unwrap_or_else(|panic| Err(panic.into())),
            ));
            wake();
        });
        match thread {
            Ok(_) => {
                self.running = Some(RunningBatch {
                    id,
                    stop,
                    news: told,
                    is_index,
                })
            }
            Err(error) => item.state = BatchState::Failed(error.to_string()),
        }
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        if let Some(running) = &self.running {
            running.stop.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn plan(variants: usize) -> BatchPlan {
        let text = format!(
            r#"{{"format":"sceneloom_batch","version":1,"base":{{"template":"straight"}},
            "sweep":[{{"name":"seed","seeds":{{"from":0,"count":{variants}}}}}],"write":[{{"format":"surroundocc"}}]}}"#
        );
        serde_json::from_str(&text).expect("a plan")
    }

    fn until(queue: &mut Queue, what: &str, is: impl Fn(&Queue) -> bool) -> Vec<u64> {
        let start = Instant::now();
        let mut ended = Vec::new();
        while !is(queue) {
            assert!(start.elapsed() < Duration::from_secs(60), "never {what}");
            ended.extend(queue.tick(|| {}));
            std::thread::sleep(Duration::from_millis(2));
        }
        ended
    }

    #[test]
    fn the_urgent_goes_first_and_the_rest_goes_on() {
        let dir = tempfile::tempdir().expect("a folder");
        let mut queue = Queue::default();
        let mut add = |name: &str, n| {
            queue
                .add(plan(n), dir.path(), &dir.path().join(name))
                .expect("added")
        };
        let (long, short) = (add("long", 6), add("short", 1));
        assert!(
            queue.add(plan(1), dir.path(), &dir.path().join("long")).is_err(),
            "twice"
        );
        until(&mut queue, "begins", |q| q.item(long).is_some_and(|i| i.done > 0));
        queue.set_priority(short, Priority::High);
        let ended = until(&mut queue, "all done", |q| {
            q.items().iter().all(|i| matches!(i.state, BatchState::Done(_)))
        });
        assert_eq!(ended, [short, long], "the long one made way");
        let BatchState::Done(report) = &queue.item(long).expect("there").state else {
            panic!("not done");
        };
        assert!(report.kept >= 1 && report.kept + report.made == 6, "{report:?}");
        // The folder belongs to another plan.
        queue.remove(long);
        let line = queue
            .add(plan(2), dir.path(), &dir.path().join("long"))
            .expect_err("taken");
        assert!(line.to_string().contains("another plan"), "{line}");
    }

    #[test]
    fn what_is_to_run_next_does() {
        let dir = tempfile::tempdir().expect("a folder");
        let mut queue = Queue::default();
        let mut add = |name: &str, n| {
            queue
                .add(plan(n), dir.path(), &dir.path().join(name))
                .expect("added")
        };
        let [first, second, third] = [add("a", 4), add("b", 1), add("c", 1)];
        queue.set_priority(first, Priority::High);
        until(&mut queue, "begins", |q| {
            q.item(first).is_some_and(|i| i.done > 0)
        });
        assert_eq!(queue.next_up(), Some(second));
        queue.run_next(third);
        assert_eq!(queue.next_up(), Some(third));
        assert_eq!(queue.item(third).map(|i| i.priority), Some(Priority::Normal));
        // A running batch cannot be moved to run next.
        queue.run_next(first);
        let ended = until(&mut queue, "all done", |q| {
            q.items().iter().all(|i| matches!(i.state, BatchState::Done(_)))
        });
        assert_eq!(ended, [first, third, second]);
    }

    #[test]
    fn pauses_marks_and_faults() {
        let dir = tempfile::tempdir().expect("a folder");
        let mut queue = Queue::default();
        let id = queue
            .add(plan(4), dir.path(), &dir.path().join("a"))
            .expect("added");
        until(&mut queue, "begins", |q| q.item(id).is_some_and(|i| i.done > 0));
        queue.pause(id);
        until(&mut queue, "stops", |q| q.running.is_none());
        assert_eq!(queue.item(id).expect("there").state, BatchState::Paused);
        assert!(queue.tick(|| {}).is_empty() && queue.running.is_none());
        queue.resume(id);
        until(&mut queue, "done", |q| {
            matches!(q.items()[0].state, BatchState::Done(_))
        });
        let index = dir.path().join("a/index.parquet");
        let before = std::fs::read(&index).expect("an index");
        queue.mark(id, |marks| marks.star(1)).expect("written");
        queue.mark(id, |marks| marks.discard(2)).expect("written");
        queue.tick(|| {});
        until(&mut queue, "indexed", |q| q.running.is_none());
        assert_ne!(std::fs::read(&index).expect("an index"), before);
        let marks = Marks::read(&dir.path().join("a")).expect("marks");
        assert!(marks.starred.contains(&1) && marks.discarded.contains(&2));
        // A variant is never both starred and discarded, and each mark can be removed.
        queue.mark(id, |marks| marks.star(2)).expect("written");
        queue.mark(id, |marks| marks.star(1)).expect("written");
        let marks = &queue.item(id).expect("there").marks;
        assert_eq!((marks.starred.len(), marks.discarded.len()), (1, 0));
        // Invalid marks are reported, and the batch is not added.
        queue.remove(id);
        std::fs::write(dir.path().join("a/marks.json"), "{").expect("written");
        assert!(queue.add(plan(4), dir.path(), &dir.path().join("a")).is_err());
    }
}
