//! Claims and their verdicts: the engines that decide them ([`claim`]), full rank on boxes ([`certificate`]), the exact sets on which a
//! rank drops ([`drops`]), and what verdicts rest on, written down for the checker ([`evidence`]).

pub mod certificate;
pub mod claim;
pub mod drops;
pub mod evidence;
