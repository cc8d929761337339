// Compares a function with a file of test vectors. To build and run it:
//
//     graphdyn vectors ur5 --out vectors
//     rustc -O -o vectors_rs vectors.rs -L . && LD_LIBRARY_PATH=. ./vectors_rs     (librnea.so: see rnea.c)

use std::fs;

/// Counts the rows with a number beyond its tolerance.
fn failures(path: &str, arguments: usize, f: impl Fn(&[f64]) -> Vec<f64>) -> usize {
    let text = fs::read_to_string(path).expect("the file can be read");
    let mut failed = 0;
    for line in text.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let answer = f(&row[..arguments]);
        let (expected, tolerances) = row[arguments..].split_at((row.len() - arguments) / 2);
        let within = |k: usize| (answer[k] - expected[k]).abs() <= tolerances[k]; // false for NaN
        if answer.len() != expected.len() || !(0..answer.len()).all(within) {
            failed += 1;
        }
    }
    failed
}

#[link(name = "rnea")]
extern "C" {
    fn rnea(n: i32, q: *const f64, v: *const f64, a: *const f64, tau: *mut f64) -> i32;
}

fn main() {
    let failed = failures("vectors/inverse_dynamics.csv", 18, |x| {
        let mut tau = vec![0.0; 6];
        unsafe { rnea(6, x.as_ptr(), x[6..].as_ptr(), x[12..].as_ptr(), tau.as_mut_ptr()) };
        tau
    });
    println!("inverse_dynamics: {failed} rows fail");
    std::process::exit((failed != 0) as i32);
}
