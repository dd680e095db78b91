//! What may befall a run: kills at any moment, a full or read-only disk, files that were cut. No finished visit is
//! lost, and no part of a file is taken for the whole. `make faults` kills fifty times, this three times.
use phr::bench::environment::{ENVIRONMENT, Environment};
use phr::bench::files::{RecordsError, read_json};
use phr::bench::phases::{self, PHASES};
use phr::bench::rounds::ROUNDS;
use phr::bench::row::{self, ROWS};
use phr::bench::samples::{SAMPLES, Samples};
use phr::random::SplitMix64;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const SCENE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\n";

/// A run into `folder`/out that takes no time for each of its rounds.
fn arguments<'a>(out: &'a str, rounds: &'a str) -> Vec<&'a str> {
    let fixed = [
        "bench",
        "x.obj",
        "--builder",
        "lbvh",
        "--width",
        "4",
        "--size",
        "8",
        "--views",
        "1",
        "--threads",
        "1",
    ];
    [&fixed[..], &["--out", out, "--rounds", rounds]].concat()
}

fn phr(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_phr")).current_dir(folder).args(arguments).output().unwrap()
}

/// As the command refuses: one line and code 2.
fn refused(output: &Output) -> String {
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), told.lines().count()), (Some(2), 1), "{told}");
    told
}

fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("x.obj"), SCENE).unwrap();
    folder
}

/// The samples on disk, of which `before` must be the beginning; none as long as no visit is done.
fn checked(out: &Path, before: &Samples) -> Samples {
    if !out.join(SAMPLES).exists() {
        assert!(before.scenes.is_empty(), "samples are lost");
        return Samples::default();
    }
    let samples = Samples::read(out).unwrap();
    for (old, new) in before.scenes.iter().zip(&samples.scenes) {
        assert!(old.cells.len() <= new.cells.len());
        for (old, new) in old.cells.iter().zip(&new.cells) {
            assert!(new.visits.starts_with(&old.visits), "a finished visit is lost or changed");
        }
    }
    assert!(before.scenes.len() <= samples.scenes.len());
    read_json::<Environment>(&out.join(ENVIRONMENT), "").unwrap();
    if out.join(ROWS).exists() {
        row::read(out).unwrap();
    }
    samples
}

/// A run of two scenes, two builders and both widths, killed now in the one scene and now in the other.
#[test]
fn kills_at_any_moment_lose_no_finished_visit() {
    let kills: usize = std::env::var("PHR_KILLS").map_or(3, |kills| kills.parse().expect("a number"));
    let folder = workplace();
    std::fs::write(folder.path().join("y.obj"), SCENE.replace("v 1 0 0", "v 2 0 0")).unwrap();
    let out = folder.path().join("out");
    let run = |rounds: usize| {
        let line = format!(
            "bench x.obj y.obj --builder lbvh --builder phr-quality --size 8 --views 1 --threads 1 --rounds {rounds}"
        );
        let mut command = Command::new(env!("CARGO_BIN_EXE_phr"));
        command.current_dir(folder.path()).args(line.split(' ')).args(["--out", "out"]);
        if out.join(SAMPLES).exists() {
            command.arg("--resume");
        }
        command
    };
    let mut random = SplitMix64::new(7);
    let mut samples = Samples::default();
    let (mut killed, mut in_the_second, mut rounds) = (0, 0, 5);
    while killed < kills {
        let mut child = run(rounds).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(random.next_u64() % 900));
        child.kill().unwrap();
        let code = child.wait().unwrap().code();
        samples = checked(&out, &samples);
        match code {
            None => {
                killed += 1;
                in_the_second += usize::from(samples.scenes.len() == 2);
            }
            // It was done before.
            Some(0) => rounds += 5,
            Some(code) => panic!("a run that is resumed ends with {code}"),
        }
    }
    let output = run(rounds).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    eprintln!("{kills} kills, {in_the_second} in the second scene, {rounds} rounds");
    samples = checked(&out, &samples);
    let visits: Vec<usize> =
        samples.scenes.iter().flat_map(|scene| &scene.cells).map(|cell| cell.visits.len()).collect();
    assert_eq!(visits, [rounds; 8], "two scenes, two builders, two widths");
}

/// Files may not be larger than a limit, as if the disk were full.
#[test]
fn a_full_disk_is_told_and_what_was_written_stays_whole() {
    let folder = workplace();
    let limited = |script: &str| {
        let all = arguments("out", "60000").join(" ");
        let script = script.replace("PHR", env!("CARGO_BIN_EXE_phr")).replace("ARGS", &all);
        Command::new("sh").current_dir(folder.path()).args(["-c", &script]).output().unwrap()
    };
    // 64 KiB, in blocks of 512 bytes; the signal is ignored, so that writing fails.
    let output = limited("trap '' XFSZ; ulimit -f 128; exec PHR ARGS");
    let told = refused(&output);
    assert!(told.contains("out/") && told.contains("--out"), "{told}");
    let out = folder.path().join("out");
    let samples = checked(&out, &Samples::default());
    assert!(!samples.scenes.is_empty());
    let left = std::fs::read_dir(&out).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    assert!(left.into_iter().all(|name| !name.ends_with(".part")), "no half file is left");
    let mut more = arguments("out", "1");
    more.push("--resume");
    assert!(phr(folder.path(), &more).status.success());
    checked(&out, &samples);
}

/// A small file system of its own, where this may mount one.
struct Mounted(std::path::PathBuf);

impl Mounted {
    fn new(place: &Path) -> Option<Self> {
        std::fs::create_dir(place).unwrap();
        let mounted = mount(&["-t", "tmpfs", "-o", "size=96k", "none"], place);
        mounted.then(|| Self(place.to_owned()))
    }
}

fn mount(options: &[&str], place: &Path) -> bool {
    let status = Command::new("mount").args(options).arg(place).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

impl Drop for Mounted {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
fn a_full_and_a_read_only_file_system() {
    let folder = workplace();
    let Some(mounted) = Mounted::new(&folder.path().join("small")) else {
        eprintln!("skipped: nothing can be mounted here");
        return;
    };
    let output = phr(folder.path(), &arguments("small/out", "60000"));
    assert!(refused(&output).contains("No space left"), "{}", String::from_utf8_lossy(&output.stderr));
    let out = mounted.0.join("out");
    let samples = checked(&out, &Samples::default());
    assert!(!samples.scenes.is_empty());
    assert!(mount(&["-o", "remount,ro"], &mounted.0));
    let mut more = arguments("small/out", "1");
    more.push("--resume");
    assert!(refused(&phr(folder.path(), &more)).contains("Read-only"), "resumed on a read-only disk");
    let mut anew = arguments("small/out", "1");
    assert!(refused(&phr(folder.path(), &anew)).contains("--replace"), "what is there is kept");
    anew.push("--replace");
    assert!(refused(&phr(folder.path(), &anew)).contains("Read-only"));
    assert_eq!(checked(&out, &samples), samples);
}

/// Every beginning of every file of a finished run is refused or is the whole.
#[test]
fn a_cut_file_is_refused() {
    let folder = workplace();
    let output = phr(folder.path(), &arguments("out", "2"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let out = folder.path().join("out");
    let (rows, samples) = (row::read(&out).unwrap(), Samples::read(&out).unwrap());
    let environment: Environment = read_json(&out.join(ENVIRONMENT), "").unwrap();
    let of_phases = phases::read(&out).unwrap();
    assert!(of_phases.len() > 1, "a cut may be at a row's end");
    for file in [ROWS, ROUNDS, PHASES, SAMPLES, ENVIRONMENT] {
        let whole = std::fs::read(out.join(file)).unwrap();
        let is_read = || -> Result<bool, RecordsError> {
            Ok(match file {
                PHASES => phases::read(&out)? == of_phases,
                SAMPLES => Samples::read(&out)? == samples,
                ENVIRONMENT => read_json::<Environment>(&out.join(file), "")? == environment,
                _ => row::read(&out)? == rows,
            })
        };
        let mut refusals = 0;
        for end in 0..whole.len() {
            // Some file systems wait for the disk when a file is replaced, not when it is gone before.
            std::fs::remove_file(out.join(file)).unwrap();
            std::fs::write(out.join(file), &whole[..end]).unwrap();
            match is_read() {
                Ok(is_whole) => assert!(is_whole, "{file}: {end} of {} bytes are taken for all", whole.len()),
                Err(error) => {
                    assert!(!error.to_string().contains('\n') && error.to_string().contains(file), "{error}");
                    refusals += 1;
                }
            }
        }
        assert!(refusals + 1 >= whole.len(), "{file}: {refusals} of {} refused", whole.len());
        std::fs::write(out.join(file), &whole).unwrap();
        assert!(is_read().unwrap());
    }
}

/// Numbers that no run writes, in records that a run reads.
#[test]
fn made_up_records_end_in_one_line_or_are_read() {
    let folder = workplace();
    assert!(phr(folder.path(), &arguments("out", "2")).status.success());
    let samples = folder.path().join("out").join(SAMPLES);
    let whole = std::fs::read_to_string(&samples).unwrap();
    for (from, to) in
        [("\"pass\":0", "\"pass\":18446744073709551615"), ("\"round\":0", "\"round\":4294967296")]
    {
        assert!(whole.contains(from), "{from}");
        std::fs::write(&samples, whole.replace(from, to)).unwrap();
        let mut more = arguments("out", "3");
        more.push("--resume");
        let output = phr(folder.path(), &more);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() || output.status.code() == Some(2), "{to}: {told}");
        assert!(!told.contains("panicked"), "{to}: {told}");
    }
}

/// What is named on the command line may be a pipe, which would be waited for without end.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused() {
    let folder = workplace();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    for all in [
        &["build", "x.obj", "--config", "pipe"][..],
        &["bench", "x.obj", "--config", "/dev/zero", "--list"],
        &["bench", "x.obj", "--tree", "pipe"],
        &["readme", "pipe"],
        &["table", "pipe"],
        &["build", "pipe"],
    ] {
        assert!(refused(&phr(folder.path(), all)).contains("not a regular file"), "{all:?}");
    }
    let map = "git_rev,cpu,scene,triangles,view,size,builder,width,threads,build_ms,steps_mean,steps_p95,steps_p99,\
               steps_max,scale\n1,a,s,1,0,8,lbvh,4,1,1.0,1.0,1,1,1,20\n# rows: 1\n";
    std::fs::write(folder.path().join("heat.csv"), map).unwrap();
    std::fs::rename(folder.path().join("pipe"), folder.path().join("heat.counts.png")).unwrap();
    let told = refused(&phr(folder.path(), &["heatmap", "--redraw", "-o", "heat.png"]));
    assert!(told.contains("heat.counts.png: not a regular file"), "{told}");
}

/// A build for which there is no memory ends in one line, not in a signal. The limit is what the scene takes, and a
/// part of the 320 MiB of leaf blocks for which a builder makes room.
#[cfg(target_os = "linux")]
#[test]
fn a_build_without_memory_is_told() {
    for builder in ["lbvh", "phr-fast", "phr-quality", "ploc"] {
        let script = format!(
            "ulimit -v {}; exec {} build scalable-4M --builder {builder} --width 4 --threads 1",
            500 << 10,
            env!("CARGO_BIN_EXE_phr")
        );
        let output = Command::new("sh").env("MALLOC_ARENA_MAX", "1").args(["-c", &script]).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(String::from_utf8_lossy(&output.stdout).contains("triangles"), "the scene is there: {told}");
        assert_eq!((output.status.code(), told.lines().count()), (Some(1), 1), "{builder}: {told}");
        assert!(told.contains("no memory for") && told.contains(" MiB; "), "{told}");
    }
}

#[test]
fn a_folder_has_one_run_at_a_time() {
    let folder = workplace();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let held = std::fs::File::open(&out).unwrap();
    if held.try_lock().is_ok() {
        let told = refused(&phr(folder.path(), &arguments("out", "1")));
        assert!(told.contains("out: another run is writing there; wait"), "{told}");
    }
    drop(held);
    assert!(phr(folder.path(), &arguments("out", "1")).status.success());
}
