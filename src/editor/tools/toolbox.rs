//! All tools with their states; one of them is in hand.

use glam::DVec2;

use super::{Hand, Tool, ToolId, all};

/// One of each tool, in the order of the table.
#[derive(Debug)]
pub struct Toolbox {
    tools: Vec<Box<dyn Tool>>,
}

impl Default for Toolbox {
    fn default() -> Self {
        Self {
            tools: all().iter().map(|def| (def.make)()).collect(),
        }
    }
}

impl Clone for Toolbox {
    /// Makes tools in their initial state: a drag belongs to one window.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Toolbox {
    fn index(id: ToolId) -> usize {
        all().iter().position(|def| def.id == id).unwrap_or(0)
    }

    /// A tool.
    pub fn tool(&self, id: ToolId) -> &dyn Tool {
        &*self.tools[Self::index(id)]
    }

    /// A tool.
    pub fn tool_mut(&mut self, id: ToolId) -> &mut dyn Tool {
        &mut *self.tools[Self::index(id)]
    }

    /// Points set so far with a tool, ego frame, m.
    pub fn points_m(&self, id: ToolId) -> &[DVec2] {
        self.tool(id).points_m()
    }

    /// Takes a tool.
    pub fn take(&mut self, hand: &mut Hand, id: ToolId) {
        self.put_down();
        hand.tool = id;
    }

    /// Drops unfinished drawings of tools that are put down.
    pub fn put_down(&mut self) {
        for tool in &mut self.tools {
            tool.put_down();
        }
    }

    /// Runs the action of a tool: mostly it takes the tool. False if there is no such action.
    pub fn shortcut(&mut self, hand: &mut Hand, id: &str) -> bool {
        let Some((def, shortcut)) = super::shortcut(id) else {
            return false;
        };
        let before = hand.tool;
        (shortcut.set)(hand);
        if hand.tool != before {
            self.put_down();
        }
        self.tool_mut(def.id).restart();
        true
    }
}
