//! Runs each test in a separate process: `cargo test --no-run --message-format=json | run_tests [FILTER...]`. With
//! filters, runs the tests whose name `PROGRAM::TEST` contains one of them.
//!
//! A test in a separate process shares no driver, environment or static value with another test, and a crash ends only
//! this test. Programs are run side by side at the same relative pace, so that programs that wait for devices and
//! windows run beside programs that compute. Tests of programs in [`PUNCTUAL`] have priority.
//!
//! A test also fails if processes that it started are still running five seconds after its end. They are then killed:
//! orphans become children of this process, and carry the test's name in their environment.

#[cfg(target_os = "linux")]
mod linux {
    use std::collections::BTreeSet;
    use std::fs::File;
    use std::io::{BufRead, IsTerminal, Read, Seek};
    use std::path::PathBuf;
    use std::process::{Child, Command, ExitCode, Stdio};
    use std::sync::mpsc::{Sender, channel};
    use std::time::{Duration, Instant};

    use rustix::process::{
        Pid, Signal, WaitId, WaitIdOptions, WaitOptions, getpriority_process, kill_process,
        set_child_subreaper, setpriority_process, waitid, waitpid,
    };
    use serde_json::Value;

    /// Programs whose tests measure time or talk to real windows and devices. All others run with a lower priority.
    const PUNCTUAL: [&str; 5] = ["callback_no_alloc", "devices", "mariana_control", "server", "windows"];
    /// The program whose tests compile many shaders, and draw few pixels with each of them. llvmpipe's optimizer is off in
    /// these tests: it takes longer than it saves.
    const COMPILING: &str = "pictures";
    /// Its tests that draw many pixels, or images of shipped scenes.
    const DRAWING: [&str; 6] =
        ["flash_limiter::", "flashes::", "golden::", "kept_paths::", "paths::", "shipped_scenes::"];
    /// The lower priority, in the units of the command `nice`.
    const NICENESS: i32 = 3;
    /// The longest that a test may take.
    const TEST_LIMIT: Duration = Duration::from_secs(900);
    /// The longest that processes of a test may take to end after the test.
    const END_LIMIT: Duration = Duration::from_secs(5);
    /// The time between two looks at the limits, the orphans and the progress while no test ends.
    const LOOK_PERIOD: Duration = Duration::from_millis(100);
    /// The time between two lines about progress, where there is no terminal.
    const REPORT_PERIOD: Duration = Duration::from_secs(30);
    /// The number of tests that the report lists with their times.
    const DEAREST: usize = 40;
    /// The variable with the name of the running test.
    const NAME: &str = "MARIANA_TEST";
    /// Unit of processor times in `/proc`, in seconds.
    const TICK: f64 = 0.01;

    /// A test program.
    struct Program {
        name: String,
        path: PathBuf,
        /// The folder of its package, in which its tests run.
        folder: PathBuf,
        tests: Vec<String>,
        started: usize,
        seconds: f64,
        processor_seconds: f64,
    }

    struct Running {
        name: String,
        program: usize,
        child: Child,
        output: File,
        start: Instant,
        is_killed: bool,
    }

    struct TestTime {
        name: String,
        seconds: f64,
        processor_seconds: f64,
    }

    #[derive(Default)]
    struct Results {
        failed: BTreeSet<String>,
        times: Vec<TestTime>,
    }

    impl Results {
        fn add(
            &mut self,
            mut test: Running,
            processor_seconds: f64,
            progress: &Progress,
        ) -> Result<(), String> {
            let seconds = test.start.elapsed().as_secs_f64();
            let status =
                test.child.wait().map_err(|error| format!("cannot wait for {}: {error}", test.name))?;
            let output = text_of(&mut test.output);
            if !status.success() || !output.contains("test result: ok. 1 passed") {
                progress.print(&format!("FAILED {} ({status}, {seconds:.1} s)\n{output}", test.name));
                self.failed.insert(test.name.clone());
            }
            self.times.push(TestTime { name: test.name, seconds, processor_seconds });
            Ok(())
        }
    }

    /// Reads cargo's messages and lists the tests of all programs.
    fn programs(filters: &[String]) -> Result<Vec<Program>, String> {
        let mut programs = Vec::new();
        for line in std::io::stdin().lock().lines() {
            let line = line.map_err(|error| format!("cannot read cargo's messages: {error}"))?;
            let Ok(message) = serde_json::from_str::<Value>(&line) else { continue };
            let (Some(path), Some(name), Some(manifest), Some(true)) = (
                message["executable"].as_str(),
                message["target"]["name"].as_str(),
                message["manifest_path"].as_str(),
                message["profile"]["test"].as_bool(),
            ) else {
                continue;
            };
            let folder = PathBuf::from(manifest).parent().map(PathBuf::from).unwrap_or_default();
            let mut program = Program {
                name: name.to_owned(),
                path: path.into(),
                folder,
                tests: Vec::new(),
                started: 0,
                seconds: 0.0,
                processor_seconds: 0.0,
            };
            let ignored = listed(&program, &["--ignored"])?;
            if let Some(test) = ignored.first() {
                return Err(format!("{name}::{test} is marked as ignored: enable or remove the test"));
            }
            program.tests = listed(&program, &[])?;
            program.tests.retain(|test| {
                let whole = format!("{name}::{test}");
                filters.is_empty() || filters.iter().any(|filter| whole.contains(filter.as_str()))
            });
            programs.push(program);
        }
        Ok(programs)
    }

    fn listed(program: &Program, options: &[&str]) -> Result<Vec<String>, String> {
        let mut command = Command::new(&program.path);
        command.args(["--list", "--format", "terse"]).args(options).current_dir(&program.folder);
        let output = command.output().map_err(|error| format!("cannot run {}: {error}", program.name))?;
        let text = String::from_utf8_lossy(&output.stdout);
        Ok(text.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect())
    }

    /// The program with the smallest share of started tests. Its next test starts.
    fn next(programs: &[Program]) -> Option<usize> {
        let open = programs.iter().enumerate().filter(|(_, program)| program.started < program.tests.len());
        let share = |program: &Program| (program.started as f64 + 0.5) / program.tests.len() as f64;
        open.min_by(|(_, a), (_, b)| share(a).total_cmp(&share(b))).map(|(number, _)| number)
    }

    /// Starts the next test of a program. When the test ends, sends the id of its process.
    fn start(programs: &mut [Program], number: usize, ended: &Sender<Pid>) -> Result<Running, String> {
        let program = &mut programs[number];
        let test = program.tests[program.started].clone();
        program.started += 1;
        let name = format!("{}::{test}", program.name);
        let failed = |error: std::io::Error| format!("cannot start {name}: {error}");
        let output = tempfile::tempfile().map_err(failed)?;
        let mut command = Command::new(&program.path);
        command.args(["--exact", &test, "--nocapture"]).current_dir(&program.folder);
        command.env(NAME, &name).env("CARGO_MANIFEST_DIR", &program.folder);
        // Programs that several tests draw with are compiled once.
        if let Some(target) = program.path.ancestors().nth(3) {
            command.env("MESA_SHADER_CACHE_DIR", target.join("tmp"));
        }
        if program.name == COMPILING && !DRAWING.iter().any(|module| test.starts_with(module)) {
            command.env("GALLIVM_PERF", "nopt");
        }
        // Tests run side by side: handing pixels to llvmpipe's threads takes up to a sixth of the processor time.
        if !PUNCTUAL.contains(&program.name.as_str()) && std::env::var_os("LP_NUM_THREADS").is_none() {
            command.env("LP_NUM_THREADS", "0");
        }
        // As for `cargo test` (`.cargo/config.toml`).
        if std::env::var_os("PROPTEST_RNG_SEED").is_none() {
            command.env("PROPTEST_RNG_SEED", "1");
        }
        let (out, err) = (output.try_clone().map_err(failed)?, output.try_clone().map_err(failed)?);
        command.stdin(Stdio::null()).stdout(out).stderr(err);
        let child = command.spawn().map_err(failed)?;
        let test = Running { name, program: number, child, output, start: Instant::now(), is_killed: false };
        if let Some(pid) = test.id() {
            if !PUNCTUAL.contains(&program.name.as_str()) {
                // Relative to the own priority, which an ordinary user cannot raise.
                let lower = getpriority_process(None).map_or(NICENESS, |own| (own + NICENESS).min(19));
                let _ = setpriority_process(Some(pid), lower);
            }
            let ended = ended.clone();
            // The process stays in the system's list, so that its times can be read.
            let wait = move || {
                let _ = waitid(WaitId::Pid(pid), WaitIdOptions::EXITED | WaitIdOptions::NOWAIT);
                let _ = ended.send(pid);
            };
            std::thread::Builder::new().spawn(wait).map_err(|error| format!("cannot wait: {error}"))?;
        }
        Ok(test)
    }

    fn text_of(file: &mut File) -> String {
        let mut bytes = Vec::new();
        let read = file.rewind().and_then(|()| file.read_to_end(&mut bytes));
        read.map_or_else(|error| error.to_string(), |_| String::from_utf8_lossy(&bytes).into_owned())
    }

    /// The processor time of an ended process and its children, in seconds.
    fn processor_seconds(pid: Pid) -> f64 {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
        fields.skip(11).take(4).filter_map(|field| field.parse::<f64>().ok()).sum::<f64>() * TICK
    }

    /// A process that has lost its parent.
    struct Orphan {
        pid: Pid,
        /// The name of the test that it belongs to.
        test: String,
        command: String,
    }

    /// The orphans of ended tests that are still running. Removes the others from the system's list of processes.
    fn orphans(running: &[Running]) -> Vec<Orphan> {
        let children = std::fs::read_to_string("/proc/thread-self/children").unwrap_or_default();
        let ids = children.split_whitespace().filter_map(|id| id.parse().ok()).filter_map(Pid::from_raw);
        let orphans = ids.filter(|pid| !running.iter().any(|test| test.id() == Some(*pid)));
        let alive = orphans.filter(|pid| !matches!(waitpid(Some(*pid), WaitOptions::NOHANG), Ok(Some(_))));
        let described = alive.map(|pid| {
            let read = |file| std::fs::read(format!("/proc/{pid}/{file}")).unwrap_or_default();
            let prefix = format!("{NAME}=");
            let test = read("environ").split(|byte| *byte == 0).find_map(|variable| {
                String::from_utf8_lossy(variable).strip_prefix(&prefix).map(str::to_owned)
            });
            let command = String::from_utf8_lossy(&read("cmdline")).replace('\0', " ");
            Orphan { pid, test: test.unwrap_or_default(), command }
        });
        // A process without a command is about to end.
        let is_left = |orphan: &Orphan| {
            !orphan.command.is_empty() && !running.iter().any(|test| test.name == orphan.test)
        };
        described.filter(is_left).collect()
    }

    impl Running {
        fn id(&self) -> Option<Pid> {
            Pid::from_raw(self.child.id().cast_signed())
        }

        fn kill(&mut self) {
            self.is_killed = true;
            if let Some(pid) = self.id() {
                // Fails if the test has ended. The processes that it started become orphans.
                let _ = kill_process(pid, Signal::KILL);
            }
        }
    }

    /// Prints the number of finished tests: in a terminal as a line that is updated, elsewhere now and then.
    struct Progress {
        is_terminal: bool,
        total: usize,
        next: Instant,
    }

    impl Progress {
        fn report(&mut self, results: &Results, running: &[Running]) {
            if Instant::now() < self.next {
                return;
            }
            let done = results.times.len();
            let mut line = format!("{:3} %  {done} of {} tests", 100 * done / self.total.max(1), self.total);
            if !results.failed.is_empty() {
                line.push_str(&format!(", {} failed", results.failed.len()));
            }
            if self.is_terminal {
                let names: Vec<&str> = running.iter().map(|test| test.name.as_str()).collect();
                eprint!("\r\x1b[K{:.100}", format!("{line}  {}", names.join(" ")));
                self.next = Instant::now() + Duration::from_millis(200);
            } else {
                eprintln!("{line}");
                self.next = Instant::now() + REPORT_PERIOD;
            }
        }

        fn clear(&self) {
            if self.is_terminal {
                eprint!("\r\x1b[K");
            }
        }

        fn print(&self, text: &str) {
            self.clear();
            println!("{text}");
        }
    }

    fn run_all(programs: &mut [Program], jobs: usize) -> Result<Results, String> {
        let mut results = Results::default();
        let mut running: Vec<Running> = Vec::new();
        // When each orphan was first seen.
        let mut seen: Vec<(Pid, Instant)> = Vec::new();
        let total = programs.iter().map(|program| program.tests.len()).sum();
        let mut progress =
            Progress { is_terminal: std::io::stderr().is_terminal(), total, next: Instant::now() };
        let (ends, ended) = channel();
        while !(running.is_empty() && seen.is_empty() && next(programs).is_none()) {
            while running.len() < jobs
                && let Some(number) = next(programs)
            {
                running.push(start(programs, number, &ends)?);
            }
            if let Ok(pid) = ended.recv_timeout(LOOK_PERIOD)
                && let Some(place) = running.iter().position(|test| test.id() == Some(pid))
            {
                let (test, processor_seconds) = (running.swap_remove(place), processor_seconds(pid));
                programs[test.program].processor_seconds += processor_seconds;
                programs[test.program].seconds += test.start.elapsed().as_secs_f64();
                results.add(test, processor_seconds, &progress)?;
            }
            let is_late = |test: &&mut Running| !test.is_killed && test.start.elapsed() > TEST_LIMIT;
            for test in running.iter_mut().filter(is_late) {
                progress.print(&format!("{} takes longer than {TEST_LIMIT:?}: killed", test.name));
                test.kill();
            }
            let orphans = orphans(&running);
            seen.retain(|(pid, _)| orphans.iter().any(|orphan| orphan.pid == *pid));
            for Orphan { pid, test, command } in orphans {
                match seen.iter().find(|(known, _)| *known == pid) {
                    None => seen.push((pid, Instant::now())),
                    Some((_, since)) if since.elapsed() > END_LIMIT => {
                        if kill_process(pid, Signal::KILL).is_ok() {
                            progress.print(&format!("FAILED {test}: left a process behind: {command}"));
                            results.failed.insert(test);
                        }
                    }
                    Some(_) => {}
                }
            }
            progress.report(&results, &running);
        }
        progress.clear();
        Ok(results)
    }

    fn print_summary(programs: &[Program], results: &mut Results) {
        println!("\n{:24} {:>6} {:>9} {:>9}", "program", "tests", "seconds", "CPU");
        let mut rows: Vec<&Program> = programs.iter().filter(|program| program.started > 0).collect();
        rows.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        for program in &rows {
            let Program { name, started, seconds, processor_seconds, .. } = program;
            println!("{name:24} {started:6} {seconds:9.1} {processor_seconds:9.1}");
        }
        let processor: f64 = rows.iter().map(|program| program.processor_seconds).sum();
        let seconds: f64 = rows.iter().map(|program| program.seconds).sum();
        println!("{:24} {:6} {seconds:9.1} {processor:9.1}", "all", results.times.len());
        results.times.sort_by(|a, b| b.processor_seconds.total_cmp(&a.processor_seconds));
        println!("\n{:>9} {:>9}  dearest tests", "seconds", "CPU");
        for TestTime { name, seconds, processor_seconds } in results.times.iter().take(DEAREST) {
            println!("{seconds:9.1} {processor_seconds:9.1}  {name}");
        }
        if !results.failed.is_empty() {
            println!("\nfailed tests");
            results.failed.iter().for_each(|name| println!("  {name}"));
        }
        // A test that left a process behind has passed and failed.
        let failed = results.failed.len();
        println!("\n{} passed, {failed} failed", results.times.len().saturating_sub(failed));
    }

    pub(super) fn main() -> ExitCode {
        let filters: Vec<String> = std::env::args().skip(1).collect();
        // Two tests and a half for two processors: one of them usually waits.
        let cores = std::thread::available_parallelism().map_or(2, usize::from);
        let jobs = std::env::var("MARIANA_TEST_JOBS").ok().and_then(|jobs| jobs.parse().ok());
        let adopted = set_child_subreaper(Some(rustix::process::getpid()));
        let run = adopted.map_err(|error| error.to_string()).and_then(|()| {
            let mut programs = programs(&filters)?;
            let mut results = run_all(&mut programs, jobs.unwrap_or(cores + 1))?;
            print_summary(&programs, &mut results);
            Ok(results)
        });
        match run {
            Ok(results) if results.failed.is_empty() && !results.times.is_empty() => ExitCode::SUCCESS,
            Ok(results) => {
                if results.times.is_empty() {
                    eprintln!("No test ran. The filters match no test, or cargo built none.");
                }
                ExitCode::FAILURE
            }
            Err(message) => {
                eprintln!("{message}");
                ExitCode::FAILURE
            }
        }
    }
}

#[cfg(target_os = "linux")]
fn main() -> std::process::ExitCode {
    linux::main()
}

#[cfg(not(target_os = "linux"))]
fn main() -> std::process::ExitCode {
    eprintln!("This runner needs Linux. Run 'cargo test' instead.");
    std::process::ExitCode::FAILURE
}
