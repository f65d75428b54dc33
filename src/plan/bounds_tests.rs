//! Lists that are longer than any test: told at once, with the line of the first entry that is too much.

use super::Test;

const HEAD: &str = "name = 'T'\nmachine = 'm.toml'\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\nname = 'A'\n\
                    coincidence_mm = [0, 0, 0]\ntool_ball_mm = [0, 0, -200]\n";
const PLAN: &str = "[plan]\nfeed_mm_min = 500.0\n";

fn listed(entry: &str, count: usize) -> String {
    (0..count).map(|k| entry.replace('#', &k.to_string())).collect()
}

#[test]
fn no_list_of_a_test_file_is_longer_than_any_test() {
    let run = "[[run]]\nprogram = 'p'\nlog = 'l'\nname = 'r#'\n";
    let mounting =
        "[[mounting]]\nname = 'M#'\ncoincidence_mm = [0, 0, 0]\ntool_ball_mm = [0, 0, -200]\n";
    let arc = "[[plan.arc]]\nkind = 'equator'\n";
    let names = format!("[identify]\nterms = [{}]\n", listed("'EXX1', ", 501));
    let wanted =
        format!("{PLAN}[design]\nbudget_min = 9\nwanted = [{}]\n", listed("'EXX1', ", 501));
    let bars =
        format!("{PLAN}[design]\nbudget_min = 9\nbar_lengths_mm = [{}]\n", listed("150, ", 21));
    let tools = format!(
        "{PLAN}[design]\nbudget_min = 9\ntool_balls_mm = [{}]\n",
        listed("[0, 0, -9], ", 21)
    );
    let arc_of = format!("{PLAN}{arc}mountings = [{}]\n", listed("'A', ", 2));
    for (rest, told, line) in [
        (listed(run, 1001), "1001 runs, and 1000 are the most", 9 + 4 * 1000 + 1),
        (listed(mounting, 100), "101 mountings, and 100 are the most", 9 + 4 * 99 + 1),
        (format!("{PLAN}{}", listed(arc, 1001)), "1001 arcs, and 1000 are the most", 11 + 2 * 1000),
        (names, "501 terms are named, and 500 are the most", 10),
        (wanted, "501 terms are named, and 500 are the most", 13),
        (bars, "21 bar lengths, and 20 are the most", 13),
        (tools, "21 tool balls, and 20 are the most", 13),
        (arc_of, "2 mountings for an arc, and 1 are the most", 13),
    ] {
        let error = Test::parse(&format!("{HEAD}{rest}"), "t.toml".as_ref()).unwrap_err();
        assert!(error.what.contains(told), "{told}: {}", error.what);
        assert_eq!(error.place.map(|place| place.line), Some(line), "{told}");
        assert!(error.hint.is_some());
    }
    for rest in [listed(run, 1000), listed(mounting, 99), format!("{PLAN}{}", listed(arc, 1000))] {
        Test::parse(&format!("{HEAD}{rest}"), "t.toml".as_ref()).unwrap();
    }
}
