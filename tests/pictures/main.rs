//! Stored pictures of workspaces, panes and dialogs, drawn by the software driver and compared, in two themes and four languages.
//! `UPDATE=1 cargo test --profile checked --workspace --test pictures` renews those that differ. A program of its own, since themes and
//! languages are the process's.

mod stored;
mod window;

use app::command::{Command, FileCommand, ViewCommand, Window};
use app::dock::Workspace;
use app::panes;
use stored::{Stored, Summary};
use widgets::theme::Theme;
use window::TestWindow;

/// Dialogs: a name, and what shows it.
fn dialogs() -> Vec<(&'static str, Command)> {
    let window = |of: Window| Command::Toggle(of);
    vec![
        ("settings", window(Window::Settings)),
        ("start", window(Window::Start)),
        ("keys", window(Window::Keys)),
        ("rig", window(Window::Sensors)),
        ("palette", window(Window::Palette)),
        ("export", window(Window::Export)),
        ("batches", window(Window::Batches)),
        ("capture", window(Window::Capture)),
        ("tour", Command::BeginTour),
        ("unsaved", Command::File(FileCommand::New)),
    ]
}

/// Panes whose content depends on how fast the machine is, or needs a graphics card's device.
const LEFT_OUT: [&str; 2] = ["trade", "view3d"];

/// All workspaces but the one of measured times, or the two with the most words.
fn workspaces(window: &mut TestWindow, stored: &mut Stored, all: bool) {
    let shown = |of: Workspace| match of {
        Workspace::Edit | Workspace::Clip => true,
        Workspace::Trade => false,
        _ => all,
    };
    for (workspace, name) in Workspace::ALL.into_iter().filter(|(of, _)| shown(*of)) {
        window.execute(Command::View(ViewCommand::Workspace(workspace)));
        stored.compare(&format!("workspace_{}", name.to_lowercase()), &window.picture());
    }
}

fn single_panes(window: &mut TestWindow, stored: &mut Stored) {
    for info in panes::infos() {
        let name = info.id.name();
        if LEFT_OUT.contains(&name) || info.id.camera().is_some_and(|camera| camera > 0) {
            continue;
        }
        window.execute(Command::View(ViewCommand::Workspace(Workspace::Edit)));
        window.execute(Command::View(ViewCommand::ShowPane(info.id)));
        window.maximize(info.id);
        stored.compare(&format!("pane_{name}"), &window.picture());
        window.maximize(info.id);
    }
    window.execute(Command::View(ViewCommand::Workspace(Workspace::Edit)));
}

fn all_dialogs(theme: Theme, language: &str, stored: &mut Stored) {
    for (name, command) in dialogs() {
        // A window of its own for each: nothing of one lies behind another.
        let mut window = TestWindow::new(theme, language);
        window.change();
        window.execute(command);
        stored.compare(&format!("dialog_{name}"), &window.picture());
    }
}

#[test]
fn workspaces_panes_and_dialogs_look_as_stored() {
    // Dialogs suggest files in the folder that the program runs in.
    std::env::set_current_dir("/").expect("a folder");
    let mut summary = Summary::default();
    for (variant, theme, language) in [
        ("dark", Theme::Dark, ""),
        ("light", Theme::Light, ""),
        ("german", Theme::Dark, "de"),
        ("japanese", Theme::Light, "ja"),
        ("chinese", Theme::Dark, "zh"),
    ] {
        let mut stored = Stored::new(variant);
        let mut window = TestWindow::new(theme, language);
        let all = language.is_empty();
        workspaces(&mut window, &mut stored, all);
        if all {
            single_panes(&mut window, &mut stored);
        }
        drop(window);
        all_dialogs(theme, language, &mut stored);
        summary.add(stored);
    }
    summary.judge();
}
