//! The services of a channel: one for the messages, two for events. The steward creates them and all other processes open them.

use crate::channel::{Channel, Qos, layout_text};
use crate::error::Error;
use crate::event;
use crate::station::{Limits, Station, Transport};
use iceoryx2::node::Node as IceNode;
use iceoryx2::prelude::*;
use iceoryx2::service::attribute::{AttributeKey, AttributeValue};
use iceoryx2::service::builder::event::EventOpenError;
use iceoryx2::service::builder::event::EventOpenOrCreateError;
use iceoryx2::service::builder::publish_subscribe::{
    Builder, PublishSubscribeCreateError, PublishSubscribeOpenError, PublishSubscribeOpenOrCreateError,
};
use iceoryx2::service::port_factory::{event as event_factory, publish_subscribe};
use shm_schemas::{FrameHeader, Layout};
use std::fmt::Debug;

/// Processes in one station: 8 roles, tools, and those that are dead and not yet removed.
const NODES: usize = 32;

/// Ports of each kind on one event service: the readers and writers of a channel, and those that are dead and not yet
/// removed. The steward needs one for a moment when it announces a death.
const EVENT_PORTS: usize = 32;

const LAYOUT_KEY: &str = "andon.layout";
const FRAME_BYTES_KEY: &str = "andon.frame_bytes";

/// What iceoryx2 asks of the payload of a message.
pub(crate) trait Payload: Debug + IceoryxSend + 'static {}
impl<P: Debug + IceoryxSend + ?Sized + 'static> Payload for P {}

/// What iceoryx2 asks of the header of a message.
pub(crate) trait Header: Debug + ZeroCopySend {}
impl<H: Debug + ZeroCopySend> Header for H {}

/// The service for messages of payload `P` with header `H`.
pub(crate) type PublishSubscribe<P, H> = publish_subscribe::PortFactory<Transport, P, H>;
pub(crate) type Messages<T> = PublishSubscribe<T, ()>;
pub(crate) type Frames = PublishSubscribe<[u8], FrameHeader>;
type Events = event_factory::PortFactory<Transport>;

/// How an attempt to open something ended.
pub(crate) enum Attempt {
    /// Not now. If a kind of port is named, all ports of that kind are taken, perhaps one of them by a dead process.
    Again(Option<&'static str>),
    /// Never.
    Failed(Error),
}

/// The three services of a channel. Holding them keeps them alive.
#[derive(Debug)]
pub(crate) struct Services<M> {
    pub(crate) messages: M,
    /// From the writer to the readers.
    pub(crate) forward: Events,
    /// From the readers to the writer.
    pub(crate) back: Events,
}

/// Why a port could not be made, with the services for the next attempt.
pub(crate) type Refused<M> = (Services<M>, Attempt);

/// Why a service could not be opened or created.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// It is not there yet: try again.
    NotYet,
    /// It was left incomplete by a process that was killed, or it is damaged.
    Incomplete(MessagingPattern),
    /// Another build created it.
    OtherBuild,
    /// Anything else, in iceoryx2's word.
    Broken(String),
}

impl From<PublishSubscribeOpenError> for Refusal {
    fn from(error: PublishSubscribeOpenError) -> Self {
        use PublishSubscribeOpenError as E;
        match error {
            E::DoesNotExist | E::IsMarkedForDestruction => Self::NotYet,
            E::HangsInCreation | E::ServiceInCorruptedState => {
                Self::Incomplete(MessagingPattern::PublishSubscribe)
            }
            E::IncompatibleAttributes
            | E::IncompatibleTypes
            | E::IncompatibleOverflowBehavior
            | E::VersionMismatch
            | E::DoesNotSupportRequestedMinBufferSize
            | E::DoesNotSupportRequestedMinHistorySize
            | E::DoesNotSupportRequestedMinSubscriberBorrowedSamples
            | E::DoesNotSupportRequestedAmountOfPublishers
            | E::DoesNotSupportRequestedAmountOfSubscribers
            | E::DoesNotSupportRequestedAmountOfNodes => Self::OtherBuild,
            other => Self::Broken(format!("{other:?}")),
        }
    }
}

impl From<PublishSubscribeOpenOrCreateError> for Refusal {
    fn from(error: PublishSubscribeOpenOrCreateError) -> Self {
        use PublishSubscribeOpenOrCreateError as E;
        match error {
            E::PublishSubscribeOpenError(error) => error.into(),
            E::PublishSubscribeCreateError(
                PublishSubscribeCreateError::HangsInCreation
                | PublishSubscribeCreateError::ServiceInCorruptedState,
            ) => Self::Incomplete(MessagingPattern::PublishSubscribe),
            E::SystemInFlux
            | E::PublishSubscribeCreateError(
                PublishSubscribeCreateError::AlreadyExists
                | PublishSubscribeCreateError::IsBeingCreatedByAnotherInstance,
            ) => Self::NotYet,
            E::PublishSubscribeCreateError(other) => Self::Broken(format!("{other:?}")),
        }
    }
}

impl From<EventOpenError> for Refusal {
    fn from(error: EventOpenError) -> Self {
        use EventOpenError as E;
        match error {
            E::DoesNotExist | E::IsMarkedForDestruction => Self::NotYet,
            E::HangsInCreation | E::ServiceInCorruptedState => Self::Incomplete(MessagingPattern::Event),
            E::IncompatibleAttributes | E::VersionMismatch | E::DoesNotSupportRequestedMaxEventId => {
                Self::OtherBuild
            }
            other => Self::Broken(format!("{other:?}")),
        }
    }
}

impl From<EventOpenOrCreateError> for Refusal {
    fn from(error: EventOpenOrCreateError) -> Self {
        match error {
            EventOpenOrCreateError::EventOpenError(error) => error.into(),
            EventOpenOrCreateError::SystemInFlux => Self::NotYet,
            EventOpenOrCreateError::EventCreateError(other) => Self::Broken(format!("{other:?}")),
        }
    }
}

/// The name of the services of a channel; the one for the events from the readers ends in `/back`.
pub(crate) fn service_name(station: &Station, channel: Channel, back: bool) -> Result<ServiceName, Refusal> {
    let suffix = if back { "/back" } else { "" };
    ServiceName::new(&format!("andon/{}/{channel}{suffix}", station.name())).map_err(broken)
}

fn broken(error: impl Debug) -> Refusal {
    Refusal::Broken(format!("{error:?}"))
}

fn require(verifier: AttributeVerifier, key: &str, value: &str) -> Result<AttributeVerifier, Refusal> {
    let key = AttributeKey::try_from(key).map_err(broken)?;
    let value = AttributeValue::try_from(value).map_err(broken)?;
    verifier.require(&key, &value).map_err(broken)
}

fn with_layout<T: Layout>() -> Result<AttributeVerifier, Refusal> {
    require(AttributeVerifier::new(), LAYOUT_KEY, &layout_text::<T>())
}

fn with_qos<P, H>(builder: Builder<P, H, Transport>, qos: Qos) -> Builder<P, H, Transport>
where
    P: Debug + IceoryxSend + ?Sized,
    H: Debug + ZeroCopySend,
{
    builder
        .max_publishers(qos.writers)
        .max_subscribers(qos.readers)
        .max_nodes(NODES)
        .enable_safe_overflow(true)
        .history_size(qos.history)
        .subscriber_max_buffer_size(qos.buffer)
        .subscriber_max_borrowed_samples(qos.borrowed)
}

/// Opens the services of a channel, or creates them, which only the steward does.
pub(crate) trait Provide: Sized {
    fn create(node: &IceNode<Transport>, station: &Station, limits: Limits) -> Result<Self, Refusal>;
    fn open(node: &IceNode<Transport>, station: &Station) -> Result<Self, Refusal>;
}

impl<T: crate::ChannelMessage> Provide for Services<Messages<T>> {
    fn create(node: &IceNode<Transport>, station: &Station, _: Limits) -> Result<Self, Refusal> {
        let name = service_name(station, T::CHANNEL, false)?;
        let builder = with_qos(node.service_builder(&name).publish_subscribe::<T>(), T::CHANNEL.qos());
        let messages = builder.open_or_create_with_attributes(&with_layout::<T>()?)?;
        let (forward, back) = create_events(node, station, T::CHANNEL)?;
        Ok(Self { messages, forward, back })
    }

    fn open(node: &IceNode<Transport>, station: &Station) -> Result<Self, Refusal> {
        let name = service_name(station, T::CHANNEL, false)?;
        let builder = node.service_builder(&name).publish_subscribe::<T>();
        let messages = builder.open_with_attributes(&with_layout::<T>()?)?;
        let (forward, back) = open_events(node, station, T::CHANNEL)?;
        Ok(Self { messages, forward, back })
    }
}

impl Provide for Services<Frames> {
    fn create(node: &IceNode<Transport>, station: &Station, limits: Limits) -> Result<Self, Refusal> {
        let name = service_name(station, Channel::Frame, false)?;
        let builder = node.service_builder(&name).publish_subscribe::<[u8]>().user_header::<FrameHeader>();
        let attributes = with_layout::<FrameHeader>()?;
        let attributes = require(attributes, FRAME_BYTES_KEY, &limits.frame_bytes.to_string())?;
        let messages = with_qos(builder, Channel::Frame.qos()).open_or_create_with_attributes(&attributes)?;
        let (forward, back) = create_events(node, station, Channel::Frame)?;
        Ok(Self { messages, forward, back })
    }

    fn open(node: &IceNode<Transport>, station: &Station) -> Result<Self, Refusal> {
        let name = service_name(station, Channel::Frame, false)?;
        let builder = node.service_builder(&name).publish_subscribe::<[u8]>().user_header::<FrameHeader>();
        let messages = builder.open_with_attributes(&with_layout::<FrameHeader>()?)?;
        let (forward, back) = open_events(node, station, Channel::Frame)?;
        Ok(Self { messages, forward, back })
    }
}

fn create_events(
    node: &IceNode<Transport>,
    station: &Station,
    channel: Channel,
) -> Result<(Events, Events), Refusal> {
    let create = |back| {
        node.service_builder(&service_name(station, channel, back)?)
            .event()
            .event_id_max_value(event::MAX_ID)
            .max_notifiers(EVENT_PORTS)
            .max_listeners(EVENT_PORTS)
            .max_nodes(NODES)
            .notifier_created_event(EventId::new(event::UP))
            .notifier_dropped_event(EventId::new(event::GONE))
            .notifier_dead_event(EventId::new(event::DEAD))
            .open_or_create()
            .map_err(Refusal::from)
    };
    Ok((create(false)?, create(true)?))
}

fn open_events(
    node: &IceNode<Transport>,
    station: &Station,
    channel: Channel,
) -> Result<(Events, Events), Refusal> {
    let open = |back| {
        node.service_builder(&service_name(station, channel, back)?).event().open().map_err(Refusal::from)
    };
    Ok((open(false)?, open(true)?))
}

/// The maximum size of a frame, for which the steward made room.
pub(crate) fn frame_bytes(frames: &Frames) -> Option<usize> {
    attribute(frames.attributes(), FRAME_BYTES_KEY)?.parse().ok()
}

/// The error for a service of another build. It names both layouts and who still holds the old one.
pub(crate) fn other_build(station: &Station, channel: Channel, ours: String) -> Error {
    let theirs = found_layout(station, channel).unwrap_or_else(|| "an unknown one".into());
    Error::LayoutMismatch { channel, ours, theirs, members: station.members_text() }
}

fn found_layout(station: &Station, channel: Channel) -> Option<String> {
    let name = service_name(station, channel, false).ok()?;
    let config = station.config().ok()?;
    let details = Transport::details(&name, &config, MessagingPattern::PublishSubscribe).ok()??;
    let attributes = details.static_details.attributes();
    let layout = attribute(attributes, LAYOUT_KEY)?;
    Some(match attribute(attributes, FRAME_BYTES_KEY) {
        Some(bytes) => format!("{layout} for frames of {bytes} bytes"),
        None => layout,
    })
}

fn attribute(attributes: &AttributeSet, key: &str) -> Option<String> {
    let key = AttributeKey::try_from(key).ok()?;
    attributes.key_value(&key, 0).map(|value| value.to_string())
}
