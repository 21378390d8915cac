//! MCP server: its instructions, and one tool per call of the vocabulary.

use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rmcp::model::{
    CallToolRequestParams, CallToolResponse, CallToolResult, ContentBlock, Implementation, ListToolsResult,
    PaginatedRequestParams, ServerCapabilities, ServerConfig, Tool, ToolAnnotations,
};
use rmcp::service::RequestContext;
use rmcp::{ErrorData, RoleServer, ServerHandler};
use tokio::sync::oneshot;

use crate::LONGEST_CALL;
use crate::call::{CallAnswer, CallDef, find, table};
use crate::desk::Stop;
use crate::schema;
use crate::service::Service;
use scene::message::quoted;

/// Instructions for a client.
const INSTRUCTIONS: &str = "Sceneloom edits driving scenes: a map from above (roads, walkways, crossings), boxes (vehicles, people), things beside the road, and voxels of 0.4 m. Lengths are in m, angles in degrees counter-clockwise from x, times in s. The ego vehicle starts at the origin: x ahead, y left, z up, the ground at z = 0. Begin with `new` or `prompt` (make \"new\"), look with `state` and `render` (what [\"bev\"]), change with `prompt` or `apply`, let things move with `add_track`, draw the voxels with `generate`, then `check` and `export`. Every call that changes the scene is one undo step. Files are read and written in one folder only.";

/// Answers an MCP client.
#[derive(Clone)]
pub struct Server {
    service: Service,
    tools: Arc<Vec<Tool>>,
}

impl Server {
    /// Makes a server that asks a service.
    pub fn new(service: Service) -> Self {
        let tools = table().iter().map(tool).collect();
        Self {
            service,
            tools: Arc::new(tools),
        }
    }
}

/// A call as a tool.
fn tool(def: &CallDef) -> Tool {
    let [args, receipt] = schema::of_call(def);
    let example = schema::example(def);
    let formats = match def.name {
        "export" => format!(" Formats: {}.", formats()),
        _ => String::new(),
    };
    let about = format!("{}{formats} Example: {example}", def.about);
    let annotations = ToolAnnotations::new()
        .read_only(!(def.changes || writes_files(def.name)))
        .destructive(false) // everything can be undone, and no file is replaced unasked
        .open_world(false);
    Tool::new(def.name, about, Arc::new(args))
        .with_raw_output_schema(Arc::new(receipt))
        .with_annotations(annotations)
}

/// The formats that can be written, each with its content.
fn formats() -> String {
    let all = formats::export::all().iter();
    let all: Vec<String> = all.map(|f| format!("{} ({})", f.id, f.title)).collect();
    all.join("; ")
}

fn writes_files(name: &str) -> bool {
    matches!(name, "save" | "render" | "export" | "keep_version" | "show")
}

/// An answer as an MCP result: the receipt as values and as text, and its picture.
fn result(answer: CallAnswer) -> CallToolResult {
    let mut result = CallToolResult::structured(answer.receipt);
    if let Some(png) = answer.picture {
        let image = ContentBlock::image(STANDARD.encode(png), "image/png");
        result.content.push(image);
    }
    result
}

impl ServerHandler for Server {
    fn get_info(&self) -> ServerConfig {
        let mut info = ServerConfig::new(ServerCapabilities::builder().enable_tools().build());
        info.server_info =
            Implementation::new("sceneloom", env!("CARGO_PKG_VERSION")).with_title("Sceneloom");
        info.instructions = Some(INSTRUCTIONS.to_owned());
        info
    }

    async fn list_tools(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<ListToolsResult, ErrorData> {
        Ok(ListToolsResult::with_all_items((*self.tools).clone()))
    }

    fn get_tool(&self, name: &str) -> Option<Tool> {
        self.tools.iter().find(|t| t.name == name).cloned()
    }

    async fn call_tool(
        &self,
        request: CallToolRequestParams,
        context: RequestContext<RoleServer>,
    ) -> Result<CallToolResponse, ErrorData> {
        let Some(def) = find(&request.name) else {
            let shown = quoted(&request.name, 40);
            return Err(ErrorData::invalid_params(format!("no tool {shown:?}"), None));
        };
        let args = request.arguments.unwrap_or_default();
        let refused = |error: String| Ok(CallToolResult::error(vec![ContentBlock::text(error)]).into());
        let (answer, answered) = oneshot::channel();
        let cancelled = context.ct.clone();
        let stop: Stop = Arc::new(move || cancelled.is_cancelled());
        // (no `await` comes before this: calls are carried out in the order in which they came)
        let asked = self
            .service
            .ask(def.name.to_owned(), args, stop, |a| drop(answer.send(a)));
        if let Err(busy) = asked {
            return refused(busy.message());
        }
        match answered.await {
            Ok(Ok(answer)) => Ok(result(answer).into()),
            Ok(Err(error)) => refused(error),
            Err(_) => refused("the session has ended".into()),
        }
    }
}

/// Why a message that is too long is refused.
pub fn too_long(bytes: u64) -> String {
    format!("the message has {bytes} bytes, expected at most {LONGEST_CALL}")
}
