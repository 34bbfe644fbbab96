use palmistry::observability::region::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let mut s = palmistry::System::read(std::path::Path::new(&args[1])).unwrap();
    let rows = match args[2].as_str() { "own" => RegionRows::Own, "-" => RegionRows::Codistribution(None), k => RegionRows::Codistribution(Some(k.parse().unwrap())) };
    let t = std::time::Instant::now();
    let mut r = Region::new(&mut s, rows, &Default::default(), None).unwrap();
    println!("{:?}", t.elapsed());
    r.run(Limits { seconds: None, boxes: Some(args[3].parse().unwrap()) }, &false.into(), &|_| ());
    println!("{:?}", t.elapsed());
    let a = r.answer();
    println!("{:?}", t.elapsed());
    for p in &a.parts { println!("{p:#?}"); }
    for m in &a.minors { println!("{m:?}"); }
    for c in &a.curve { println!("   {:>10} {:>8.2} s {:.6}", c.boxes, c.seconds, c.proved); }
    println!("proved {} of sampled {} vanish {} rest {} candidates {} {} {:?}", a.proved, a.proved_of_sampled, a.minor_vanishes, a.rest, a.candidates, a.all_minors, a.remarks);
    let t = std::time::Instant::now();
    let text = r.saved();
    println!("saved {} MB {:?}", text.len() as f64 / 1e6, t.elapsed());
    let mut q = Region::new(&mut s, rows, &Default::default(), None).unwrap();
    let t = std::time::Instant::now();
    q.resume(&text).unwrap();
    println!("resumed {:?}", t.elapsed());
}
