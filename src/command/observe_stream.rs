//! `palmistry observe SCENE --data -`: measurements from standard input, and an answer as soon as a window is there.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::Form;
use super::{Status, Unusable};
use palmistry::experiment::{Scene, StreamPiece, observe_stream};
use palmistry::file::{self, note};
use palmistry::report::{
    forget_seconds, stream_end_json, stream_end_text, stream_json, stream_text, versioned,
};
use palmistry::system::Code;
use serde_json::Value;
use std::io::{ErrorKind, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// So many bytes are read at once; of a slow writer fewer.
const PIECE: usize = 1 << 16;

/// So many pieces may wait.
const WAITING: usize = 4;

/// How often the interrupt is looked at while nothing arrives.
const PAUSE: Duration = Duration::from_millis(20);

/// Observes standard input by a scene.
pub(super) fn observe(scene: Scene, form: Form, no_times: bool) -> miette::Result<Status> {
    let pieces = standard_input()?;
    let mut next = || match pieces.recv_timeout(PAUSE) {
        Ok(piece) => piece,
        Err(RecvTimeoutError::Timeout) => StreamPiece::Nothing,
        Err(RecvTimeoutError::Disconnected) => StreamPiece::End,
    };
    let (mut is_told, mut unwritten) = (false, None);
    let mut tell = |text: &str| {
        if !std::mem::replace(&mut is_told, true) {
            begin_to_tell();
        }
        match file::print_heard(text) {
            Ok(is_heard) => is_heard,
            Err(error) => {
                unwritten = Some(error);
                false
            }
        }
    };
    let line = |mut object: Value| {
        if no_times {
            forget_seconds(&mut object);
        }
        format!("{}\n", palmistry::foreign::json_text(&versioned(object), false))
    };
    let end = observe_stream(scene, &INTERRUPTED, &mut next, &mut |report| {
        tell(&match form {
            Form::Json => line(stream_json(report)),
            Form::Text => stream_text(report, !no_times),
        })
    })?;
    tell(&match form {
        Form::Json => line(stream_end_json(&end, interrupted())),
        Form::Text => format!("{}\n", stream_end_text(&end)),
    });
    if let Some(error) = unwritten {
        let help = "nothing of what was found is kept: free some space, or send it elsewhere";
        return Err(Unusable::report(Code::Place, format!("cannot write to standard output: {error}"), help));
    }
    if let Some(why) = &end.cut_off {
        let windows = if end.windows == 1 { "1 window is" } else { &format!("{} windows are", end.windows) };
        note(&format!("cut off: {why}; {windows} answered"));
    }
    if let Some(fault) = end.fault {
        let help = "mend the rows, or let faulty rows be skipped (on_fault = \"skip\" in the scene)";
        note(&format!("{:?}", Unusable::report(Code::Question, fault, help)));
        return Ok(Status::Unusable);
    }
    Ok(match (end.is_sound(), &end.cut_off) {
        (true, Some(_)) => Status::CutOff,
        (is_sound, _) => Status::of(is_sound),
    })
}

/// What arrives on standard input, piece by piece.
fn standard_input() -> miette::Result<Receiver<StreamPiece>> {
    let (sender, pieces) = sync_channel(WAITING);
    let thread = std::thread::Builder::new().spawn(move || {
        let mut input = std::io::stdin().lock();
        let mut piece = vec![0; PIECE];
        loop {
            let arrived = match input.read(&mut piece) {
                Ok(0) => StreamPiece::End,
                Ok(length) => StreamPiece::Bytes(piece[..length].to_vec()),
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => StreamPiece::Broken(format!("standard input cannot be read: {error}")),
            };
            let is_last = !matches!(arrived, StreamPiece::Bytes(_));
            if sender.send(arrived).is_err() || is_last {
                break;
            }
        }
    });
    match thread {
        Ok(_) => Ok(pieces),
        Err(error) => Err(Unusable::report(
            Code::System,
            format!("the system gives no thread to read on: {error}"),
            "end other programs first",
        )),
    }
}
