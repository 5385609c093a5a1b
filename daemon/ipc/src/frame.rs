//! Writing and reading frames: bytes of any length with a [`FrameHeader`], which are written once and read in place.

use crate::channel::Channel;
use crate::error::Error;
use crate::publication::Publication;
use crate::service::{Attempt, Frames, Refused, Services, frame_bytes};
use crate::station::Transport;
use crate::subscription::Subscription;
use crate::wait::{Wake, sealed};
use iceoryx2::sample::Sample;
use iceoryx2::sample_mut::SampleMut;
use shm_schemas::{FrameHeader, MessageId, RoleId, flag};
use std::os::fd::BorrowedFd;

const CHANNEL: Channel = Channel::Frame;

/// Writes frames.
#[derive(Debug)]
pub struct FrameWriter {
    publication: Publication<[u8], FrameHeader>,
    max_bytes: usize,
}

/// A frame being filled in the place where its readers will read it. If it is dropped, it was never sent.
#[derive(Debug)]
pub struct FrameLoan(SampleMut<Transport, [u8], FrameHeader>);

impl FrameLoan {
    /// The header, which is zero at first. Sending it sets its stamp, except `captured_ns`.
    pub fn header_mut(&mut self) -> &mut FrameHeader {
        self.0.user_header_mut()
    }

    /// The pixels: the colour plane, then the depth plane, then room for what a camera has sent instead of them. Until they are written they are
    /// those of an earlier frame.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        self.0.payload_mut()
    }
}

impl FrameWriter {
    /// Makes a writer; gives the services back where that must be tried again.
    pub(crate) fn new(services: Services<Frames>) -> Result<Self, Refused<Frames>> {
        let Some(max_bytes) = frame_bytes(&services.messages) else {
            let error = Error::transport(CHANNEL, "opening", "no frame size");
            return Err((services, Attempt::Failed(error)));
        };
        let publication =
            Publication::new(services, CHANNEL, |builder| builder.initial_max_slice_len(max_bytes))?;
        Ok(Self { publication, max_bytes })
    }

    /// Touches the memory that frames of this size will use, so that the first ones are not late. The kernel clears a page at its first use, which
    /// takes 3 to 5 ms per frame.
    ///
    /// # Errors
    /// As [`FrameWriter::loan`].
    pub fn warm_up(&mut self, bytes: usize) -> Result<(), Error> {
        // All at the same time: a loan that is given back would be loaned again.
        let mut loans = Vec::with_capacity(CHANNEL.qos().loans);
        for _ in 0..CHANNEL.qos().loans {
            let mut loan = self.loan(bytes)?;
            loan.bytes_mut().fill(0);
            loans.push(loan);
        }
        Ok(())
    }

    /// The newest frame that was sent; its `seq` is 0 before the first.
    pub fn newest(&self) -> MessageId {
        self.publication.newest()
    }

    /// From now on this writer waits for the readers of these roles, as with [`crate::Writer::follow`].
    pub fn follow(&mut self, readers: &[RoleId]) {
        self.publication.follow(readers);
    }

    /// A place for a frame of this many bytes in shared memory.
    ///
    /// # Errors
    /// [`Error::FrameTooLarge`]; [`Error::Transport`] when more loans are open than the channel has.
    pub fn loan(&self, bytes: usize) -> Result<FrameLoan, Error> {
        if bytes > self.max_bytes {
            return Err(Error::FrameTooLarge { bytes, max: self.max_bytes });
        }
        let sample = self.publication.publisher().loan_slice_uninit(bytes);
        let sample = sample.map_err(|e| self.publication.error("loaning", e))?;
        // SAFETY: the bytes belong to a mapped file. So each has a value whether or not this program has written it, and every value is a valid u8.
        #[allow(unsafe_code)]
        let sample = unsafe { sample.assume_init() };
        Ok(FrameLoan(sample))
    }

    /// Numbers the frame, sends it and wakes the readers. Returns its `seq`.
    ///
    /// # Errors
    /// [`Error::NoRoomYet`] when the writer is paced and nobody waited for room; [`Error::Transport`].
    pub fn send(&mut self, mut loan: FrameLoan) -> Result<u64, Error> {
        let stamp = &mut loan.header_mut().stamp;
        self.publication.number(stamp)?;
        stamp.frame_seq = stamp.seq;
        self.publication.send(loan.0)
    }
}

impl sealed::Poll for FrameWriter {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        self.publication.poll()
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.publication.fd()
    }
}

impl sealed::Room for FrameWriter {
    fn make_room(&mut self) -> Result<bool, Error> {
        self.publication.make_room()
    }
}

/// Reads frames.
#[derive(Debug)]
pub struct FrameReader {
    subscription: Subscription<[u8], FrameHeader>,
    skipped: u64,
    lost_by_source: u64,
}

/// A frame, read where its writer filled it. Dropping it gives the place back to the writer.
#[derive(Debug)]
pub struct FrameSample(Sample<Transport, [u8], FrameHeader>);

impl FrameSample {
    /// The header.
    pub fn header(&self) -> &FrameHeader {
        self.0.user_header()
    }

    /// All bytes: the colour plane, then the depth plane, then what a camera has sent instead of them.
    pub fn bytes(&self) -> &[u8] {
        self.0.payload()
    }

    /// The colour plane, [`FrameHeader::colour_bytes`] of them.
    ///
    /// # Errors
    /// [`Error::FrameTorn`] when the header promises more than the frame has.
    pub fn colour(&self) -> Result<&[u8], Error> {
        self.plane(0, self.header().colour_bytes())
    }

    /// The depth plane, `depth_height * depth_stride` bytes; empty when there is none.
    ///
    /// # Errors
    /// As [`FrameSample::colour`].
    pub fn depth(&self) -> Result<&[u8], Error> {
        let begin = self.header().colour_bytes().unwrap_or(usize::MAX);
        self.plane(begin, self.header().depth_bytes())
    }

    /// The JPEG that the colour plane was decoded from, as the camera sent it, where it is there and whole.
    pub fn jpeg(&self) -> Option<&[u8]> {
        let header = self.header();
        let begin = header.colour_bytes()?.checked_add(header.depth_bytes()?)?;
        let bytes = (header.jpeg_bytes > 0).then_some(header.jpeg_bytes as usize);
        bytes.and_then(|bytes| self.bytes().get(begin..begin.checked_add(bytes)?))
    }

    fn plane(&self, begin: usize, bytes: Option<usize>) -> Result<&[u8], Error> {
        let end = bytes.and_then(|bytes| begin.checked_add(bytes)).unwrap_or(usize::MAX);
        self.bytes().get(begin..end).ok_or(Error::FrameTorn {
            seq: self.header().stamp.seq,
            promised: end,
            bytes: self.bytes().len(),
        })
    }
}

impl FrameReader {
    /// Makes a reader; gives the services back where that must be tried again.
    pub(crate) fn new(services: Services<Frames>, role: RoleId) -> Result<Self, Refused<Frames>> {
        let subscription = Subscription::new(services, CHANNEL, role)?;
        Ok(Self { subscription, skipped: 0, lost_by_source: 0 })
    }

    /// The oldest frame that waits. For paced sources, where every frame counts.
    ///
    /// # Errors
    /// [`Error::Transport`] when too many samples are held.
    pub fn take(&mut self) -> Result<Option<FrameSample>, Error> {
        let sample = self
            .subscription
            .take(|subscriber| subscriber.receive(), |sample| &sample.user_header().stamp)?
            .map(FrameSample);
        self.lost_by_source += sample.as_ref().map_or(0, |sample| u64::from(sample.header().dropped));
        Ok(sample)
    }

    /// The newest frame; older ones that wait are skipped and counted by [`FrameReader::skipped`]. For live sources,
    /// where a late frame is worth less than the next one. Of a source that waits for its readers nothing is skipped: until its first
    /// frame has come, its reader cannot know that it waits.
    ///
    /// # Errors
    /// As [`FrameReader::take`]. It holds two samples for a moment, so that nobody who keeps another one may call it.
    pub fn take_newest(&mut self) -> Result<Option<FrameSample>, Error> {
        let mut newest = None;
        while let Some(sample) = self.take()? {
            self.skipped += u64::from(newest.is_some());
            let waits = sample.header().flags & flag::PACED != 0;
            newest = Some(sample);
            if waits {
                break;
            }
        }
        Ok(newest)
    }

    /// The newest `seq` of this epoch of the writer that has come; 0 where none has.
    pub fn newest_of(&self, epoch: u64) -> u64 {
        self.subscription.losses().newest_of(epoch)
    }

    /// Connects again at the next poll, although iceoryx2 has not said that one could not be made. What was lost
    /// meanwhile is counted, and what the writer still has comes.
    pub fn reconnect(&mut self) {
        self.subscription.recreate();
    }

    /// Frames received, including those that were skipped.
    pub fn received(&self) -> u64 {
        self.subscription.losses().received
    }

    /// Frames that were sent while this reader was there and that it did not get in time.
    pub fn lost(&self) -> u64 {
        self.subscription.losses().lost
    }

    /// Frames that [`FrameReader::take_newest`] skipped for a newer one.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Frames that the source lost before the writer had them: [`FrameHeader::dropped`] of all frames received.
    pub fn lost_by_source(&self) -> u64 {
        self.lost_by_source
    }

    /// How often the writer has started again since the first frame.
    pub fn restarts(&self) -> u32 {
        self.subscription.losses().restarts
    }
}

impl sealed::Poll for FrameReader {
    fn poll(&mut self) -> Result<Option<Wake>, Error> {
        self.subscription.poll()
    }

    fn fd(&self) -> BorrowedFd<'_> {
        self.subscription.fd()
    }
}
