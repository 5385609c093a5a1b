//! Answers well-formed requests from the state machine.

use std::future::{Ready, ready};
use std::net::IpAddr;
use std::sync::Arc;

use tokio_modbus::{ExceptionCode, Request, Response, SlaveRequest, server};

use super::counters::Counters;
use super::written::Write;
use super::{Cause, Open, Shared};
use crate::registers::{self, RegisterError};

/// The service of one connection.
pub(super) struct Service {
    pub(super) shared: Arc<Shared>,
    /// Who is at its other end.
    pub(super) client: IpAddr,
    /// Counts the connection until the service is dropped with it.
    pub(super) _open: Open,
}

impl server::Service for Service {
    type Request = SlaveRequest<'static>;
    type Response = Response;
    type Exception = ExceptionCode;
    type Future = Ready<Result<Response, ExceptionCode>>;

    fn call(&self, request: Self::Request) -> Self::Future {
        let answer = self.answer(&request.request);
        if answer.is_err() {
            Counters::add(&self.shared.counters.exceptions);
        }
        ready(answer)
    }
}

impl Service {
    fn answer(&self, request: &Request<'_>) -> Result<Response, ExceptionCode> {
        match request {
            Request::ReadHoldingRegisters(address, count) => {
                self.read(*address, *count).map(Response::ReadHoldingRegisters)
            }
            Request::ReadInputRegisters(address, count) => {
                self.read(*address, *count).map(Response::ReadInputRegisters)
            }
            Request::WriteSingleRegister(address, word) => {
                self.write(*address, &[*word])?;
                Ok(Response::WriteSingleRegister(*address, *word))
            }
            Request::WriteMultipleRegisters(address, words) => {
                self.write(*address, words)?;
                // The gate lets at most 123 registers through.
                Ok(Response::WriteMultipleRegisters(*address, words.len() as u16))
            }
            _ => Err(ExceptionCode::IllegalFunction),
        }
    }

    fn read(&self, address: u16, count: u16) -> Result<Vec<u16>, ExceptionCode> {
        let image = self.shared.handshake().image(self.shared.now_ns());
        registers::read(&image, self.shared.word_order, address, count).map_err(exception)
    }

    fn write(&self, address: u16, words: &[u16]) -> Result<(), ExceptionCode> {
        if let Some(cause) = self.objection_to_writing() {
            Counters::add(&self.shared.counters.writes_refused);
            self.shared.counters.rejections.add(self.client, cause);
            return Err(ExceptionCode::IllegalFunction);
        }
        let now_ns = self.shared.now_ns();
        let mut handshake = self.shared.handshake();
        let image = handshake.image(now_ns);
        let written = registers::write(&image, self.shared.word_order, address, words).map_err(exception)?;
        handshake.write(written, now_ns);
        drop(handshake);
        self.shared.note(Write { client: self.client, before: image.control, after: written });
        Ok(())
    }

    fn objection_to_writing(&self) -> Option<Cause> {
        match (self.shared.writes, self.shared.commanders.contains(&self.client)) {
            (false, _) => Some(Cause::WritesOff),
            (true, false) => Some(Cause::NoCommander),
            (true, true) => None,
        }
    }
}

fn exception(error: RegisterError) -> ExceptionCode {
    match error {
        RegisterError::Address(_) => ExceptionCode::IllegalDataAddress,
        RegisterError::Value(_) => ExceptionCode::IllegalDataValue,
    }
}
