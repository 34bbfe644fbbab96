fn main() {
    let mut a = std::env::args().skip(1);
    let f = a.next().unwrap();
    let mut s = palmistry::System::read(f.as_ref()).unwrap();
    let no = std::sync::atomic::AtomicBool::new(false);
    let answer = palmistry::drops::where_it_drops(&mut s, 1, &no).unwrap();
    println!(
        "rank {} of {} final {} exact {} reach {:?} cases {:?} {:.2} s",
        answer.rank,
        answer.dimension,
        answer.is_final,
        answer.is_exact(),
        answer.out_of_reach,
        answer.cases,
        answer.seconds
    );
    for m in &answer.minors {
        println!("MINOR on {:?}: {:?} {:?}", m.equations, m.rows, m.factors);
    }
    for d in &answer.sets {
        println!(
            "DROPS to {} where {:?} unless {:?} 2^{} e.g. {:?}",
            d.rank,
            d.equations,
            d.unless,
            d.log2_error,
            d.state.as_ref().map(|s| s.iter().map(|c| format!("{}={}", c.name, c.exact)).collect::<Vec<_>>())
        );
    }
    for d in &answer.open {
        println!("OPEN rank {} where {:?} unless {:?}: {:?}", d.rank, d.equations, d.unless, d.open);
    }
}
