//! The topics of a recording, and how the bytes on each are to be read.

use andon_ipc::Channel;

use crate::viewer;

/// What the bytes of a message are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Topic {
    /// The bytes of a message of this channel, as they lay in shared memory. Of frames it is the header alone.
    Raw(Channel),
    /// What the recorder did not get: a [`crate::Losses`] as JSON.
    Losses,
    /// A picture, as `foxglove.CompressedImage`.
    Picture,
    /// A sentence for people, as `foxglove.Log`.
    Log,
    /// The distance of an IU over its threshold: over 1 is an anomaly.
    Ratio,
    /// A measure that was out of its bounds.
    Measure,
}

/// How a topic is described in the file.
pub(crate) struct Description {
    pub(crate) schema: String,
    pub(crate) schema_encoding: &'static str,
    pub(crate) schema_data: Vec<u8>,
    pub(crate) message_encoding: &'static str,
}

/// The encoding of schemas whose data is the layout hash of the message, in hexadecimal digits.
const LAYOUT: &str = "andon-layout";

impl Topic {
    /// Every topic.
    pub fn all() -> impl Iterator<Item = Self> {
        let raw = Channel::ALL.into_iter().map(Self::Raw);
        raw.chain([Self::Losses, Self::Picture, Self::Log, Self::Ratio, Self::Measure])
    }

    /// The name in the file.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Raw(channel) => format!("/raw/{channel}"),
            Self::Losses => "/losses".into(),
            Self::Picture => "/camera".into(),
            Self::Log => "/log".into(),
            Self::Ratio => "/distance_over_threshold".into(),
            Self::Measure => "/measure".into(),
        }
    }

    /// The topic of this name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::all().find(|topic| topic.name() == name)
    }

    pub(crate) fn description(self) -> Description {
        match self {
            Self::Raw(channel) => Description {
                schema: format!("andon.{channel}"),
                schema_encoding: LAYOUT,
                schema_data: layout(channel).into_bytes(),
                message_encoding: "andon",
            },
            Self::Losses => Description {
                schema: "andon.losses".into(),
                schema_encoding: "jsonschema",
                schema_data: br#"{"type":"object"}"#.to_vec(),
                message_encoding: "json",
            },
            Self::Picture => protobuf("foxglove.CompressedImage"),
            Self::Log => protobuf("foxglove.Log"),
            Self::Ratio | Self::Measure => protobuf("andon.Number"),
        }
    }
}

/// The layout hash of a channel's messages, as its schema has it.
pub(crate) fn layout(channel: Channel) -> String {
    format!("{:016x}", channel.layout())
}

fn protobuf(schema: &str) -> Description {
    Description {
        schema: schema.into(),
        schema_encoding: "protobuf",
        schema_data: viewer::descriptors(),
        message_encoding: "protobuf",
    }
}
