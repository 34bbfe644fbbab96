pub mod number;
pub mod expression;
pub mod system;
pub mod observability;
pub mod claim;
