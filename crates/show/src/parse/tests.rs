use super::*;
use crate::{CAMERA_TURNS, print};
use proptest::prelude::*;

fn cue_list(text: &str) -> CueList {
    let parsed = parse("test.show", text);
    parsed.cue_list.clone().unwrap_or_else(|| panic!("{}", parsed.render(false)))
}

#[test]
fn a_show_is_read() {
    let read = cue_list(
        "# my show\r\nat start speakers\r\n\r\nat section b 2 + 1.5 beats tunnel camera inside melt over 2 bars # why\n\
         \tset swell = -0.2 -> .5 over 8 bars -> 1 over 1 beat after 1 s\nat 1:02.5 - 3 s \"my own/orb.scene\" portal\nat end first-steps cut",
    );
    assert_eq!(read.entries.len(), 4);
    let tunnel = &read.entries[1];
    assert_eq!(tunnel.when, When { anchor: Anchor::Section("B".to_owned(), 2), offset: Length::Beats(1.5) });
    assert_eq!(tunnel.camera.as_deref(), Some("inside"));
    assert_eq!(tunnel.transition, Some(Transition::new(TransitionStyle::Melt, Length::Bars(2.0))));
    let swell = Setting {
        param: "swell".to_owned(),
        from: -0.2,
        steps: vec![Step { to: 0.5, over: Length::Bars(8.0) }, Step { to: 1.0, over: Length::Beats(1.0) }],
        after: Length::Seconds(1.0),
        span: tunnel.settings[0].span,
    };
    assert_eq!(tunnel.settings, [swell]);
    let orb = &read.entries[2];
    assert_eq!(orb.when, When { anchor: Anchor::Time(62.5), offset: Length::Seconds(-3.0) });
    assert_eq!(
        (orb.scene.as_str(), orb.transition.map(|one| one.length)),
        ("my own/orb.scene", Some(Length::Bars(1.0)))
    );
    assert_eq!((&read.entries[3].when.anchor, read.entries[3].scene.as_str()), (&Anchor::End, "first-steps"));
}

#[test]
fn each_mistake_is_reported_with_a_position_and_a_hint() {
    let cases = [
        ("", "the show has no entries", "at start speakers"),
        ("on start speakers", "a line cannot begin with `on`", "`at`"),
        ("sett a = 1", "a line cannot begin with `sett`", "did you mean `set`"),
        ("set a = 1", "needs an entry above it", "`at start`"),
        ("at", "expected a moment, found the end of the line", "`start`"),
        ("at strat x", "`strat` is not a moment of a song", "did you mean `start`"),
        ("at 1:75 x", "the seconds after the colon must be below 60", "1:23.5"),
        ("at bar 0 x", "`0` is not a whole number from 1", "count from 1"),
        ("at bar 1.5 x", "`1.5` is not a whole number from 1", "count from 1"),
        ("at 1.2.3 x", "a number is expected here, not `1.2.3`", ""),
        ("at section 2 x", "a section's name is a letter, not `2`", "`section B`"),
        ("at start", "expected a scene's name, found the end of the line", "quotes"),
        ("at start 5", "a scene's name is expected here, not `5`", "quotes"),
        ("at start x metl over 2 bars", "`metl` is not a transition", "did you mean `melt`"),
        ("at start x melt over 2", "expected `bars`, `beats` or `s`, found the end", "2 bars"),
        ("at start x melt over 2 years", "`years` is not a unit of time", "`bars`"),
        ("at start x cut over 2 bars", "`over` is not expected here", "at WHEN SCENE"),
        ("at start x\nset a 3", "expected `=` and a value, found `3`", "set swell"),
        ("at start x\nset a = 3 -> 4", "expected `over`", "8 bars"),
        ("at start x\nset a = b", "a number is expected here, not `b`", ""),
        ("at start x\nset picture brightness = 2", "2 is not between 0 and 1", "from 0 to 1"),
        ("at start x\nset picture freeze = 1 -> -1 over 1 s", "-1 is not between 0 and 1", "from 0 to 1"),
        (
            "at start x\nset picture frieze = 1",
            "there is no `frieze` in `set picture`",
            "did you mean `freeze`",
        ),
        ("at start x\nset picture glow = 1", "there is no `glow` in `set picture`", "`brightness`, `freeze`"),
        ("at start x\nset camera roll = 1", "there is no `roll` in `set camera`", "`yaw`, `pitch`, `zoom`"),
        ("at start x\nset pictur freeze = 1", "there is no `pictur freeze`", "did you mean `picture freeze`"),
        ("at start x\nset picture 3", "expected `=` and a value, found `3`", "set swell"),
        ("at start x portal bal over 2 bars", "`bal` is not a portal shape", "did you mean `ball`"),
        (
            "at start x portal square over 2 bars",
            "`square` is not a portal shape",
            "`ball`, `plane`, `shape`",
        ),
        ("at start x\n-> 1 over 1 s", "there is no `set` line above", "`set`"),
        ("at start x\nset = 1\n-> 1 over 1 s", "a parameter's name is expected here", "quotes"),
        ("at start x\nset a = 1\n-> 1 over 1 s after 1 s", "`after` is not expected here", ""),
        ("at previous + 1 bar x", "`previous` needs an entry above it", "`at start`"),
        ("at 99999999 x", "a time must not exceed 86400 s", ""),
    ];
    for (text, message, hint) in cases {
        let parsed = parse("test.show", text);
        assert!(parsed.cue_list.is_none(), "{text}");
        let reported = parsed.render(false);
        assert!(reported.contains(message) && reported.contains(hint), "{text}:\n{reported}");
        assert_eq!(parsed.diagnostics.len(), 1, "{text}:\n{reported}");
    }
    let all = parse("test.show", "at start x flay\nat start y\nset = 1");
    assert_eq!(all.diagnostics.len(), 2, "{}", all.render(false));
    assert!(all.render(false).contains("test.show:1:12"), "{}", all.render(false));
}

#[test]
fn an_animation_may_continue_on_further_lines() {
    let read = cue_list(
        "at start x\nset a = 1 after 2 s\n -> 2 over 1 s -> 3 over 1 s # up\n\n -> 1 over 4 s\nset b = 1",
    );
    let whole =
        cue_list("at start x\nset a = 1 -> 2 over 1 s -> 3 over 1 s -> 1 over 4 s after 2 s\nset b = 1");
    let steps = |cue_list: &CueList| {
        let settings = cue_list.entries[0].settings.iter();
        settings.map(|one| (one.from, one.steps.clone(), one.after)).collect::<Vec<_>>()
    };
    assert_eq!(steps(&read), steps(&whole));
}

#[test]
fn too_long_shows_exceed_a_limit() {
    use mariana_field::lang::Fault;
    let fault = |text: &str| parse("test.show", text).diagnostics.first().map(|one| one.fault);
    assert_eq!(fault(&"at start x\n".repeat(limits::ENTRIES_MAX + 1)), Some(Fault::OverLimit));
    assert_eq!(fault(&"#".repeat(limits::BYTES_MAX + 1)), Some(Fault::OverLimit));
    let steps = format!("at start x\nset a = 1{}", " -> 1 over 1 s".repeat(limits::STEPS_MAX + 1));
    assert_eq!(fault(&steps), Some(Fault::OverLimit));
    let lines = format!("at start x\nset a = 1{}", "\n-> 1 over 1 s".repeat(limits::STEPS_MAX + 1));
    assert_eq!(fault(&lines), Some(Fault::OverLimit));
    let settings = format!("at start x\n{}", "set a = 1\n".repeat(limits::SETTINGS_MAX + 1));
    assert_eq!(fault(&settings), Some(Fault::OverLimit));
}

prop_compose! {
    fn length()(number in 0u32..400, unit in 0usize..3) -> Length {
        (Length::UNITS[unit].of)(f64::from(number) / 4.0)
    }
}

const SHAPES: [PortalShape; 3] = [PortalShape::Ball, PortalShape::Plane, PortalShape::Own];

prop_compose! {
    fn entry()(
        anchor in prop_oneof![
            Just(Anchor::Start), Just(Anchor::End), Just(Anchor::Cue), Just(Anchor::Previous), (0u32..90_000).prop_map(|t| Anchor::Time(f64::from(t) / 8.0)),
            (1u32..999).prop_map(Anchor::Bar), (1u32..9).prop_map(Anchor::Drop), (1u32..9).prop_map(Anchor::Build),
            ("[A-Z]{1,2}", 1u32..9).prop_map(|(letter, number)| Anchor::Section(letter, number)),
        ],
        offset in length(), before in any::<bool>(),
        scene in "[a-z_]{1,8}|[a-z]{1,4}[ /.][a-z]{1,4}", camera in proptest::option::of("[a-z]{1,8}"),
        (style, unfinished, by_fader) in (0usize..5, any::<bool>(), any::<bool>()), shape in 0usize..3, over in length(), swell in proptest::option::of((-9i16..9, proptest::collection::vec((-9i16..9, length()), 0..14), length(), 0usize..7)),
    ) -> Entry {
        let value = |number: i16, name: usize| {
            let number = f32::from(number) / 8.0;
            if name < CAMERA_TURNS.len() { number } else { number.abs().min(1.0) }
        };
        let negative = |length| match length {
            Length::Seconds(number) => Length::Seconds(-number),
            Length::Beats(number) => Length::Beats(-number),
            Length::Bars(number) => Length::Bars(-number),
        };
        let offset = if offset.number() == 0.0 { Length::ZERO } else if before { negative(offset) } else { offset };
        let transition = TransitionStyle::ALL.get(style).map(|style| (*style, by_fader && *style != TransitionStyle::Cut));
        let transition = transition.map(|(style, by_fader)| Transition {
            kind: match style {
                TransitionStyle::Portal => TransitionKind::Blend(BlendKind::Portal(SHAPES[shape])),
                other => other.into(),
            },
            length: if by_fader || style == TransitionStyle::Cut { Length::ZERO } else { over },
            unfinished: unfinished && !by_fader && style != TransitionStyle::Cut,
            by_fader,
        });
        let settings = swell.into_iter().map(|(from, steps, after, name)| Setting {
            param: plain_settings().nth(name).unwrap_or("swell").to_owned(),
            from: value(from, name),
            steps: steps.into_iter().map(|(to, over)| Step { to: value(to, name), over }).collect(),
            after: if after.number() == 0.0 { Length::ZERO } else { after },
            span: Span::default(),
        }).collect();
        Entry { settings, ..Entry::new(When { anchor, offset }, &scene, camera, transition) }
    }
}

proptest! {
    #[test]
    fn a_printed_cue_list_is_parsed_as_the_same(mut entries in proptest::collection::vec(entry(), 1..6)) {
        if entries[0].when.anchor == Anchor::Previous {
            entries[0].when.anchor = Anchor::Start;
        }
        let text = print(&CueList { entries: entries.clone() }, &[]);
        let mut read = cue_list(&text);
        for entry in &mut read.entries {
            let nowhere = Span::default();
            (entry.span, entry.scene_span, entry.camera_span) = (nowhere, nowhere, nowhere);
            entry.settings.iter_mut().for_each(|setting| setting.span = nowhere);
        }
        prop_assert_eq!(read.entries, entries, "{}", text);
    }

    #[test]
    fn no_text_makes_the_parser_panic(text in "(at|set|bar|section|start|over|melt|[0-9.:]{1,4}|[-=>\"#+\\n ]|\\PC){0,40}") {
        let parsed = parse("test.show", &text);
        prop_assert_eq!(parsed.cue_list.is_some(), parsed.diagnostics.is_empty());
        let _ = parsed.render(false);
    }
}
