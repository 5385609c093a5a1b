//! Prints `REGISTERS.md`: `cargo run -p andon-plc --example registers > daemon/plc/REGISTERS.md`.

fn main() {
    print!("{}", andon_plc::document());
}
