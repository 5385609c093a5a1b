//! What viewers of recordings understand: pictures, sentences and numbers as Protocol Buffers, with their descriptions.
//!
//! The names and numbers of the fields of `foxglove.CompressedImage` and `foxglove.Log` are those of Foxglove's published schemas.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet, Timestamp,
};

/// `foxglove.CompressedImage`.
#[derive(Clone, PartialEq, prost::Message)]
pub struct CompressedImage {
    /// The picture's own time, UTC.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// The file of the picture.
    #[prost(bytes = "vec", tag = "2")]
    pub data: Vec<u8>,
    /// What kind of file: `jpeg`.
    #[prost(string, tag = "3")]
    pub format: String,
    /// Whose frame of reference: `camera`.
    #[prost(string, tag = "4")]
    pub frame_id: String,
}

/// `foxglove.Log`.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Log {
    /// When, UTC.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// A [`Level`].
    #[prost(int32, tag = "2")]
    pub level: i32,
    /// The sentence.
    #[prost(string, tag = "3")]
    pub message: String,
    /// Who says it: a role.
    #[prost(string, tag = "4")]
    pub name: String,
}

/// How much a sentence matters, as `foxglove.Log` counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// All is well.
    Info = 2,
    /// Not judged, noted, or lost.
    Warning = 3,
    /// An anomaly.
    Error = 4,
}

/// A number at a time.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Number {
    /// When, UTC.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// The number.
    #[prost(double, tag = "2")]
    pub value: f64,
    /// What it is, as `strokes`.
    #[prost(string, tag = "3")]
    pub name: String,
}

/// A time as these messages have it, from nanoseconds since 1970 UTC.
#[must_use]
pub fn timestamp(utc_ns: u64) -> Option<Timestamp> {
    const SECOND: u64 = 1_000_000_000;
    // 2^64 ns are 584 years: both fit.
    Some(Timestamp { seconds: (utc_ns / SECOND) as i64, nanos: (utc_ns % SECOND) as i32 })
}

/// The descriptions of these messages, as the schemas of a file hold them.
pub(crate) fn descriptors() -> Vec<u8> {
    let file = |name: &str, package: &str, dependency: &[&str]| FileDescriptorProto {
        name: Some(name.into()),
        package: Some(package.into()),
        dependency: dependency.iter().map(|&name| name.into()).collect(),
        syntax: Some("proto3".into()),
        ..FileDescriptorProto::default()
    };
    let time = || field("timestamp", 1, Type::Message, Some(".google.protobuf.Timestamp"));
    let timestamp = FileDescriptorProto {
        message_type: vec![message(
            "Timestamp",
            vec![field("seconds", 1, Type::Int64, None), field("nanos", 2, Type::Int32, None)],
        )],
        ..file(TIMESTAMP, "google.protobuf", &[])
    };
    let image = vec![
        time(),
        field("data", 2, Type::Bytes, None),
        field("format", 3, Type::String, None),
        field("frame_id", 4, Type::String, None),
    ];
    let mut log = message(
        "Log",
        vec![
            time(),
            field("level", 2, Type::Enum, Some(".foxglove.Log.Level")),
            field("message", 3, Type::String, None),
            field("name", 4, Type::String, None),
            field("file", 5, Type::String, None),
            field("line", 6, Type::Fixed32, None),
        ],
    );
    log.enum_type = vec![levels()];
    let number = vec![time(), field("value", 2, Type::Double, None), field("name", 3, Type::String, None)];
    let foxglove = FileDescriptorProto {
        message_type: vec![message("CompressedImage", image), log],
        ..file("foxglove.proto", "foxglove", &[TIMESTAMP])
    };
    let andon = FileDescriptorProto {
        message_type: vec![message("Number", number)],
        ..file("andon.proto", "andon", &[TIMESTAMP])
    };
    FileDescriptorSet { file: vec![timestamp, foxglove, andon] }.encode_to_vec()
}

const TIMESTAMP: &str = "google/protobuf/timestamp.proto";

fn levels() -> EnumDescriptorProto {
    let words = ["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"];
    let value = |(number, word): (i32, &str)| EnumValueDescriptorProto {
        name: Some(word.into()),
        number: Some(number),
        options: None,
    };
    EnumDescriptorProto {
        name: Some("Level".into()),
        value: (0..).zip(words).map(value).collect(),
        ..EnumDescriptorProto::default()
    }
}

fn message(name: &str, field: Vec<FieldDescriptorProto>) -> DescriptorProto {
    DescriptorProto { name: Some(name.into()), field, ..DescriptorProto::default() }
}

fn field(name: &str, number: i32, kind: Type, of: Option<&str>) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.into()),
        json_name: Some(name.into()),
        number: Some(number),
        label: Some(Label::Optional.into()),
        r#type: Some(kind.into()),
        type_name: of.map(str::to_owned),
        ..FieldDescriptorProto::default()
    }
}
