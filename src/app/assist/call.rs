//! The vocabulary: every call with its arguments, its receipt, and its description for clients.

use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::calls;
use crate::desk::Desk;
use scene::message;

/// One operation: its arguments are the type itself.
pub trait Operation: DeserializeOwned + JsonSchema {
    /// Name of the call.
    const NAME: &'static str;
    /// Description for a client that knows nothing: one or a few sentences, with units.
    const ABOUT: &'static str;
    /// One example of its arguments, as JSON.
    const EXAMPLE: &'static str;
    /// True if it may change the scene.
    const CHANGES: bool;
    /// Receipt of the call.
    type Receipt: Serialize + JsonSchema;

    /// Carries it out. Errors in one line; the scene is then as before.
    fn run(self, desk: &mut Desk) -> anyhow::Result<Self::Receipt>;

    /// A small PNG picture that goes with the receipt, for clients that can look at one.
    fn picture(_: &mut Self::Receipt) -> Option<Vec<u8>> {
        None
    }
}

/// A call as its table describes it.
pub struct CallDef {
    /// See [`Operation::NAME`].
    pub name: &'static str,
    /// See [`Operation::ABOUT`].
    pub about: &'static str,
    /// See [`Operation::EXAMPLE`].
    pub example: &'static str,
    /// See [`Operation::CHANGES`].
    pub changes: bool,
    /// Schema of the arguments.
    pub args: fn(&mut schemars::SchemaGenerator) -> schemars::Schema,
    /// Schema of the receipt.
    pub receipt: fn(&mut schemars::SchemaGenerator) -> schemars::Schema,
}

/// Answer to a call.
#[derive(Debug)]
pub struct CallAnswer {
    /// The receipt as JSON, an object.
    pub receipt: Value,
    /// A PNG picture that goes with it.
    pub picture: Option<Vec<u8>>,
}

macro_rules! calls {
    ($($(#[$doc:meta])* $name:ident($args:ty),)+) => {
        /// One call with its arguments.
        pub enum Call {
            $($(#[$doc])* $name(Box<$args>),)+
        }

        /// Receipt of each call.
        #[derive(Serialize)]
        #[serde(untagged)]
        pub enum Receipt {
            $($(#[$doc])* $name(Box<<$args as Operation>::Receipt>),)+
        }

        /// Every call, in the order of lists.
        pub fn table() -> Vec<CallDef> {
            vec![$(CallDef {
                name: <$args>::NAME,
                about: <$args>::ABOUT,
                example: <$args>::EXAMPLE,
                changes: <$args>::CHANGES,
                args: |generator| generator.subschema_for::<$args>(),
                receipt: |generator| generator.subschema_for::<<$args as Operation>::Receipt>(),
            },)+]
        }

        impl Call {
            /// Reads a call. Errors in one line if there is no such call or its arguments are not as they should be.
            pub fn parse(name: &str, args: Map<String, Value>) -> Result<Self, String> {
                $(if name == <$args>::NAME {
                    return Ok(Self::$name(Box::new(read::<$args>(args)?)));
                })+
                Err(unknown(name))
            }

            /// Carries it out. Errors in one line; the scene is then as before.
            pub fn run(self, desk: &mut Desk) -> Result<(Receipt, Option<Vec<u8>>), String> {
                match self {
                    $(Self::$name(args) => {
                        let mut receipt = args.run(desk).map_err(|e| message::of_error(e.as_ref()))?;
                        let picture = <$args>::picture(&mut receipt);
                        Ok((Receipt::$name(Box::new(receipt)), picture))
                    })+
                }
            }
        }
    };
}

calls! {
    /// See [`calls::state`].
    State(calls::state::GetState),
    /// See [`calls::new`].
    New(calls::new::New),
    /// See [`calls::open`].
    Open(calls::open::OpenCall),
    /// See [`calls::save`].
    Save(calls::save::Save),
    /// See [`calls::files`].
    Files(calls::files::ListFiles),
    /// See [`calls::prompt`].
    Prompt(calls::prompt::PromptCall),
    /// See [`calls::apply`].
    Apply(calls::apply::Apply),
    /// See [`calls::place_model`].
    PlaceModel(calls::place_model::PlaceModel),
    /// See [`calls::tracks`].
    AddTrack(calls::tracks::AddTrack),
    /// See [`calls::tracks`].
    RemoveTrack(calls::tracks::RemoveTrack),
    /// See [`calls::tracks`].
    Tracks(calls::tracks::ListTracks),
    /// See [`calls::show`].
    Show(calls::show::Show),
    /// See [`calls::generate`].
    Generate(calls::generate::GenerateCall),
    /// See [`calls::render`].
    Render(calls::render::Render),
    /// See [`calls::check`].
    Check(calls::check::CheckCall),
    /// See [`calls::diff`].
    Diff(calls::diff::Diff),
    /// See [`calls::export`].
    Export(calls::export::Export),
    /// See [`calls::history`].
    Undo(calls::history::Undo),
    /// See [`calls::history`].
    Redo(calls::history::Redo),
    /// See [`calls::history::History`].
    History(calls::history::History),
    /// See [`calls::versions`].
    KeepVersion(calls::versions::KeepVersion),
    /// See [`calls::versions`].
    RestoreVersion(calls::versions::RestoreVersion),
    /// See [`calls::versions`].
    Versions(calls::versions::ListVersions),
}

/// The call of that name.
pub fn find(name: &str) -> Option<CallDef> {
    table().into_iter().find(|c| c.name == name)
}

/// Arguments of one type; an error names the key.
fn read<T: Operation>(args: Map<String, Value>) -> Result<T, String> {
    serde_path_to_error::deserialize(Value::Object(args)).map_err(|e| {
        let place = e.path().to_string();
        let inner = e.into_inner();
        let line = match place.as_str() {
            "." => format!("{}: {inner}", T::NAME),
            place => format!("{}: {place}: {inner}", T::NAME),
        };
        message::one_line(&line)
    })
}

fn unknown(name: &str) -> String {
    let names: Vec<&str> = table().iter().map(|c| c.name).collect();
    let shown = message::quoted(name, 40);
    message::one_line(&format!(
        "no call {shown:?}, expected one of {}",
        names.join(", ")
    ))
}

impl Call {
    /// Reads a call and carries it out; see [`Call::parse`] and [`Call::run`].
    pub fn answer(name: &str, args: Map<String, Value>, desk: &mut Desk) -> Result<CallAnswer, String> {
        let (receipt, picture) = Self::parse(name, args)?.run(desk)?;
        let receipt = serde_json::to_value(receipt).map_err(|e| message::one_line(&e))?;
        Ok(CallAnswer { receipt, picture })
    }
}
