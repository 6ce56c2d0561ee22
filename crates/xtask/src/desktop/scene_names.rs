//! Shell completions that offer the shipped scenes for `--scene`, beside files. clap can offer either a fixed set of
//! values or files.

use anyhow::ensure;
use clap_complete::Shell;
use mariana::scenes::shipped_names;

/// Changes each completion of `--scene` in a script that clap has generated.
///
/// # Errors
/// Fails if the script has no completion of `--scene` of the known form.
pub(super) fn offered(shell: Shell, script: &str) -> anyhow::Result<String> {
    let names = shipped_names().join(" ");
    let mut changed = 0;
    let mut after_flag = false;
    let mut text = String::new();
    for line in script.lines() {
        let new = match shell {
            Shell::Bash if after_flag => {
                let files = r#"COMPREPLY=($(compgen -f "${cur}"))"#;
                let both = format!(r#"COMPREPLY=($(compgen -f -W "{names}" -- "${{cur}}"))"#);
                line.contains(files).then(|| line.replace(files, &both))
            }
            Shell::Zsh if line.contains("--scene=[") => {
                let both = format!(r#":{{_alternative "scenes:scene:({names})" "files:file:_files"}}' \"#);
                line.strip_suffix(":_default' \\").map(|start| format!("{start}{both}"))
            }
            Shell::Fish if line.contains(" -l scene ") => {
                line.strip_suffix(" -r").map(|start| format!("{start} -r -a \"{names}\""))
            }
            _ => None,
        };
        after_flag = line.trim() == "--scene)";
        changed += usize::from(new.is_some());
        text.push_str(new.as_deref().unwrap_or(line));
        text.push('\n');
    }
    ensure!(changed > 3, "clap's script for {shell} no longer has the known form: {changed} places fit");
    Ok(text)
}
