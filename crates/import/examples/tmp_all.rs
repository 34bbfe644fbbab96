use palmistry_import::{ImportQuestion, import};
fn main() {
    for file in std::env::args().skip(1) {
        let Ok(text) = std::fs::read_to_string(&file) else { continue };
        println!("==== {file}");
        match import(&file, &text, &ImportQuestion::default()) {
            Ok(read) => println!("{}", read.text),
            Err(why) => {
                println!("ERR {:?} {}; {}", why.line_and_column(), why.message, why.help.unwrap_or_default())
            }
        }
    }
}
