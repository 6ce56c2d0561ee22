# Print an optspec for argparse to handle cmd's options that are independent of any subcommand.
function __fish_mariana_global_optspecs
    string join \n mic system shuffle repeat= device= silent once volume= latency= fps-cap= fade= prepare-ahead= program-cache= fullscreen clean size= show= osc= osc-send= osc-rate= midi= remote= new gl-info quality= flash-limiter= brightness= blackout-fade= flip= crop= corners= output= wallpaper send= send-size= send-fps= scene= view= sdf= regions= tone-map= gain= shaders= v/verbose h/help V/version
end

function __fish_mariana_needs_command
    # Figure out if the current invocation already has a command.
    set -l cmd (commandline -opc)
    set -e cmd[1]
    argparse -s (__fish_mariana_global_optspecs) -- $cmd 2>/dev/null
    or return
    if set -q argv[1]
        # Also print the command, so this can be used to figure out what it is.
        echo $argv[1]
        return 1
    end
    return 0
end

function __fish_mariana_using_subcommand
    set -l cmd (__fish_mariana_needs_command)
    test -z "$cmd"
    and return 1
    contains -- $cmd[1] $argv
end

complete -c mariana -n "__fish_mariana_needs_command" -l repeat -d 'Which tracks are repeated' -r -f -a "all\t'All tracks, again and again'
one\t'One track, again and again'
off\t'Each track once; the window stays open'"
complete -c mariana -n "__fish_mariana_needs_command" -l device -d 'Output device, or input with --mic and --system: an id or name from \'mariana devices\', or part of one, or \'default\' for the system\'s [default: what was chosen in the window, at first the system\'s]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l volume -d 'Volume at the start, in percent [default: the last one, at first 100]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l latency -d 'How much later the sound is heard than the device reports; negative for earlier [default: what [ and ] set last]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l fps-cap -d 'Maximum frames per second [default: the monitor\'s rate]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l fade -d 'How many seconds one scene fades into another with N and P; 0 cuts' -r
complete -c mariana -n "__fish_mariana_needs_command" -l prepare-ahead -d 'Whether the next and the previous scene are prepared while one is shown' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l program-cache -d 'Whether programs that the driver has compiled are kept, in the user\'s folder for caches' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l size -d 'Size of the window in pixels [default: the last one, at first 1280x720]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l show -d 'Whether scenes follow the song: \'auto\' or \'off\', or a .show file [default: what was chosen in the window, at first auto unless a scene is named]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l osc -d 'Hear OSC messages on this port: of this computer alone, or with ADDRESS:PORT of that address; docs/osc.md tells what they can do' -r
complete -c mariana -n "__fish_mariana_needs_command" -l osc-send -d 'Send what is heard to another program or to lights, by OSC' -r
complete -c mariana -n "__fish_mariana_needs_command" -l osc-rate -d 'How often a second it is sent' -r
complete -c mariana -n "__fish_mariana_needs_command" -l midi -d 'Whether MIDI devices are heard; J maps them' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l remote -d 'Let phones on the network steer the show by a page on this port, or with ADDRESS:PORT of that address alone: J shows the code to scan; docs/remote.md tells what is protected' -r
complete -c mariana -n "__fish_mariana_needs_command" -l quality -d 'How good the picture is; auto draws fewer pixels if frames take too long [default: what was chosen in the window, at first auto]' -r -f -a "auto\t'As good as the frame rate allows'
low\t'About half of the window\'s width and height'
medium\t''
high\t''
best\t'Every pixel, every term, however long it takes'"
complete -c mariana -n "__fish_mariana_needs_command" -l flash-limiter -d 'Whether flashes are dimmed if there are more than three a second, as WCAG 2.3.1 asks for [default: what was chosen in the window, at first on]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l brightness -d 'How much of its light the picture has in the window, in percent [default: what was chosen there, at first 100]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l blackout-fade -d 'How many seconds a blackout (X) takes to come and to go, and a picture that was held (Z) to give way [default: what was chosen in the window, at first 0.5]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l flip -d 'Mirror the picture in the window, for projectors [default: what was chosen there, at first off]' -r -f -a "off\t''
horizontal\t'For a screen that is lit from behind'
vertical\t''
both\t'For a projector that hangs upside down'"
complete -c mariana -n "__fish_mariana_needs_command" -l crop -d 'What the picture in the window loses at its edges, in percent; what is left fills the window, unstretched [default: what was chosen last, at first 0,0,0,0]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l corners -d 'Where the picture\'s corners lie in the window, in percent to the right and down, clockwise from the upper left: for a projector that stands aslant. \'off\' is the window\'s own corners [default: where Y has put them]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l output -d 'Fill a monitor with the clean picture, by its name or number, while the window stays beside it; \'list\' tells which there are, \'off\' fills none [default: what was chosen in the window]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l send -d 'Send the picture to another program: y4m:FIFO, y4m:- (standard output), mjpeg:PORT (HTTP on this machine, for OBS or a browser) or v4l2:/dev/videoN (a camera by v4l2loopback); can be given more than once' -r
complete -c mariana -n "__fish_mariana_needs_command" -l send-size -d 'Size of the pictures that are sent [default: the window\'s at the start]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l send-fps -d 'How many pictures are sent in a second' -r
complete -c mariana -n "__fish_mariana_needs_command" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r
complete -c mariana -n "__fish_mariana_needs_command" -l view -d 'Show how the picture is made, with a legend: - steps: steps of the ray from the eye, blue to red; steps:NUMBER sets the count shown in red, 100 by default - slice: the distance on a plane through what the camera looks at, as lines; slice:NUMBER sets the distance between two lines - normals: directions of the surfaces, by differences of the distance; normals:NUMBER sets the length of a difference, by default a share of the pixel - shadow: the share of the lamps\' light that arrives - occlusion: the share of the light from everywhere that arrives - clauses: clauses that the interpreter runs; evaluations if compiled; clauses:NUMBER sets the count shown in red - cells: the cells of the regions, and how long their tapes are - materials: a colour for each object - depth: the distance to the surface; depth:NUMBER sets the distance shown in black ' -r
complete -c mariana -n "__fish_mariana_needs_command" -l sdf -d 'How the scene\'s formulas are run; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l regions -d 'Whether rays skip empty space and run tapes shortened for the place; the picture is the same [default: where that costs less; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l tone-map -d 'How light is turned into screen colours [default: scene, or in a window what was chosen there]' -r -f -a "scene\t'As the scene says, otherwise agx'
agx\t''
aces\t''
reinhard\t''
none\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l gain -d 'Whether quiet and loud sound are levelled for the picture; values in decibels are as measured either way [default: auto, or in a window what was chosen there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_needs_command" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_needs_command" -l mic -d 'Show what a microphone or another input hears, instead of a song'
complete -c mariana -n "__fish_mariana_needs_command" -l system -d 'Show what the computer plays, instead of a song'
complete -c mariana -n "__fish_mariana_needs_command" -l shuffle -d 'Play the tracks in random order'
complete -c mariana -n "__fish_mariana_needs_command" -l silent -d 'Play without sound, in real time'
complete -c mariana -n "__fish_mariana_needs_command" -l once -d 'End with the last track instead of starting over'
complete -c mariana -n "__fish_mariana_needs_command" -l fullscreen -d 'Start in full screen'
complete -c mariana -n "__fish_mariana_needs_command" -l clean -d 'Show nothing over the picture but what was asked for and what is wrong: no first words, answers or bar'
complete -c mariana -n "__fish_mariana_needs_command" -l new -d 'Begin anew instead of where the last show ended, and leave nothing to the next one; what was chosen in the panel of settings still counts'
complete -c mariana -n "__fish_mariana_needs_command" -l gl-info -d 'Print which OpenGL is available, and exit'
complete -c mariana -n "__fish_mariana_needs_command" -l wallpaper -d 'Be the desktop\'s ground, on X11 or on Wayland with layer shell: below every window, on every monitor, for the eyes alone; at most 30 frames a second unless --fps-cap says otherwise. It rests while nobody sees it, and on battery. Media keys pause the song'
complete -c mariana -n "__fish_mariana_needs_command" -s v -l verbose -d 'Log what happens; twice for more'
complete -c mariana -n "__fish_mariana_needs_command" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_needs_command" -s V -l version -d 'Print version'
complete -c mariana -n "__fish_mariana_needs_command" -a "still" -d 'Render one moment of a song to a PNG, JPEG or WebP, without a window or a sound card'
complete -c mariana -n "__fish_mariana_needs_command" -a "video" -d 'Render a stretch of a song to a video (needs ffmpeg) or to numbered stills'
complete -c mariana -n "__fish_mariana_needs_command" -a "analyze" -d 'Print the features of a song, one line for each frame'
complete -c mariana -n "__fish_mariana_needs_command" -a "bench" -d 'Measure frame times and distance evaluations, without a window'
complete -c mariana -n "__fish_mariana_needs_command" -a "check" -d 'Check scenes: print every mistake with its place, or what the scene costs'
complete -c mariana -n "__fish_mariana_needs_command" -a "tape" -d 'Print the tape of a scene\'s distance: the clauses that an interpreter runs'
complete -c mariana -n "__fish_mariana_needs_command" -a "eval" -d 'Evaluate a scene\'s distance at points, one number per line'
complete -c mariana -n "__fish_mariana_needs_command" -a "show" -d 'Write down the show that follows a song, as a file to edit'
complete -c mariana -n "__fish_mariana_needs_command" -a "scenes" -d 'List the shipped scenes, with what each shows'
complete -c mariana -n "__fish_mariana_needs_command" -a "devices" -d 'List the sound systems, inputs and outputs with what they support'
complete -c mariana -n "__fish_mariana_needs_command" -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c mariana -n "__fish_mariana_using_subcommand still" -l at -d 'The moment, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l size -d 'Size in pixels' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -s o -l output -d 'The PNG, JPEG or WebP file to write, or \'-\' for a PNG on standard output' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand still" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l show -d 'Show the moment of a show instead of a scene: \'auto\' for one that follows the song, or a .show file' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l into -d 'Show how the scene turns into this one' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l blend -d 'How it turns into that scene, and how far, 0 to 1: melt, where every surface flows from one scene to the other; ball, where the other scene is inside a growing ball; plane, where the other scene is behind a moving plane; shape, where the other scene is inside a shape that it names' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l set -d 'Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l view -d 'Show how the picture is made, with a legend: - steps: steps of the ray from the eye, blue to red; steps:NUMBER sets the count shown in red, 100 by default - slice: the distance on a plane through what the camera looks at, as lines; slice:NUMBER sets the distance between two lines - normals: directions of the surfaces, by differences of the distance; normals:NUMBER sets the length of a difference, by default a share of the pixel - shadow: the share of the lamps\' light that arrives - occlusion: the share of the light from everywhere that arrives - clauses: clauses that the interpreter runs; evaluations if compiled; clauses:NUMBER sets the count shown in red - cells: the cells of the regions, and how long their tapes are - materials: a colour for each object - depth: the distance to the surface; depth:NUMBER sets the distance shown in black ' -r
complete -c mariana -n "__fish_mariana_using_subcommand still" -l sdf -d 'How the scene\'s formulas are run; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l regions -d 'Whether rays skip empty space and run tapes shortened for the place; the picture is the same [default: where that costs less; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l tone-map -d 'How light is turned into screen colours [default: scene, or in a window what was chosen there]' -r -f -a "scene\t'As the scene says, otherwise agx'
agx\t''
aces\t''
reinhard\t''
none\t''"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l gain -d 'Whether quiet and loud sound are levelled for the picture; values in decibels are as measured either way [default: auto, or in a window what was chosen there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand still" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand still" -l alpha -d 'Leave out the sky, so that the picture can be laid over another one: in PNG and WebP, for scenes whose sky has no colour of its own'
complete -c mariana -n "__fish_mariana_using_subcommand still" -s v -l verbose -d 'Log what happens; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand still" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand video" -l for -d 'Make it as a place wants it: its size, rate and length; other flags still count' -r -f -a "youtube\t'1920x1080 at 60 frames a second'
reel\t'Upright, 1080x1920 at 30 frames a second, the first 90 seconds'
story\t'Upright, 1080x1920 at 30 frames a second, the first 60 seconds'
square\t'1080x1080 at 30 frames a second'
loop\t'Upright, 1080x1920 at 30 frames a second; 8 seconds without sound, whose end fades into their beginning'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l start -d 'Where to start, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l duration -d 'Length, as 80 or 1:20.5 [default: to the end, or as --for says]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l fps -d 'Frames per second [default: 30, or as --for says]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l size -d 'Size in pixels [default: 1280x720, or as --for says]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l codec -d 'How the picture is encoded [default: as the ending of the file\'s name says]' -r -f -a "h264\t'What everything plays'
h265\t'Half of the bytes'
vp9\t'For webm'
av1\t'The smallest, and the slowest to make'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l quality -d 'How much of the picture the encoding keeps' -r -f -a "low\t'A small preview'
medium\t''
high\t'Hardly a difference is seen'
best\t'For services that encode it once more'"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l flash-limiter -d 'Whether flashes are dimmed if there are more than three a second, as WCAG 2.3.1 asks for' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l scene -d 'The scene to show, as for \'still\'; several with the time in the song from which on each is shown, such as --scene orb --scene city@1:20 [default: speakers]' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l show -d 'A show instead of scenes: \'auto\' for one that follows the song, made of all shipped scenes or of those that --scene names; \'demo\' for that of the demo track; or a .show file' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l set -d 'Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -s o -l output -d 'The video to write (mp4, mkv, mov, webm, or gif and webp without sound), a folder ending in \'/\' for numbered PNGs, or \'-\' for y4m without sound on standard output' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand video" -l view -d 'Show how the picture is made, with a legend: - steps: steps of the ray from the eye, blue to red; steps:NUMBER sets the count shown in red, 100 by default - slice: the distance on a plane through what the camera looks at, as lines; slice:NUMBER sets the distance between two lines - normals: directions of the surfaces, by differences of the distance; normals:NUMBER sets the length of a difference, by default a share of the pixel - shadow: the share of the lamps\' light that arrives - occlusion: the share of the light from everywhere that arrives - clauses: clauses that the interpreter runs; evaluations if compiled; clauses:NUMBER sets the count shown in red - cells: the cells of the regions, and how long their tapes are - materials: a colour for each object - depth: the distance to the surface; depth:NUMBER sets the distance shown in black ' -r
complete -c mariana -n "__fish_mariana_using_subcommand video" -l sdf -d 'How the scene\'s formulas are run; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l regions -d 'Whether rays skip empty space and run tapes shortened for the place; the picture is the same [default: where that costs less; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l tone-map -d 'How light is turned into screen colours [default: scene, or in a window what was chosen there]' -r -f -a "scene\t'As the scene says, otherwise agx'
agx\t''
aces\t''
reinhard\t''
none\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l gain -d 'Whether quiet and loud sound are levelled for the picture; values in decibels are as measured either way [default: auto, or in a window what was chosen there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand video" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand video" -l title-card -d 'Show the song\'s title and artist over the first five seconds'
complete -c mariana -n "__fish_mariana_using_subcommand video" -l alpha -d 'Leave out the sky, so that the video can be laid over another one: in webm, mov, mkv, webp and PNGs, for scenes whose sky has no colour of its own'
complete -c mariana -n "__fish_mariana_using_subcommand video" -s q -l quiet -d 'Tell nothing but mistakes'
complete -c mariana -n "__fish_mariana_using_subcommand video" -s v -l verbose -d 'Log what happens; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand video" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l plot -d 'Draw the song on one page: waveform, energy, beats, bars, sections, builds, drops, chords, chroma, and the show that follows it' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l gain -d 'Whether quiet and loud sound are levelled in the values from 0 to 1' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l fps -d 'Lines per second' -r
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l start -d 'Where to start, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l duration -d 'Length, as 80 or 1:20.5 [default: to the end]' -r
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l structure -d 'What the whole song is made of instead of its moments: tempo, bars, key, sections, builds, drops'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l song -d 'Print what is known of the whole song at each moment, too: bar, section, energy, build, drop, ...'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -l json -d 'One JSON object per line: t, volume as [left, right], bands as 32 numbers, ...; with --structure one object'
complete -c mariana -n "__fish_mariana_using_subcommand analyze" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l at -d 'The moment that is drawn, as 80 or 1:20.5' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l size -d 'Size in pixels' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l frames -d 'Frames to time' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l only -d 'With --all: only the scenes whose names contain this; may be given several times' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l scene -d 'The scene to show: a file, the name of a shipped scene (\'mariana scenes\' lists them), or a formula such as "length(p) - 1" [default: speakers]' -r
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l sdf -d 'How the scene\'s formulas are run; auto interprets at once and compiles in the background' -r -f -a "interpreted\t''
compiled\t''
auto\t''"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l regions -d 'Whether rays skip empty space and run tapes shortened for the place; the picture is the same [default: where that costs less; bench measures both]' -r -f -a "on\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l tone-map -d 'How light is turned into screen colours [default: scene, or in a window what was chosen there]' -r -f -a "scene\t'As the scene says, otherwise agx'
agx\t''
aces\t''
reinhard\t''
none\t''"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l gain -d 'Whether quiet and loud sound are levelled for the picture; values in decibels are as measured either way [default: auto, or in a window what was chosen there]' -r -f -a "auto\t''
off\t''"
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l shaders -d 'Read the shaders from this folder, to work on them' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l all -d 'Measure all shipped scenes'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l edges -d 'Also compare the picture at edges with one of 64 samples per pixel; slow'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -l json -d 'Print JSON instead of text'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -s v -l verbose -d 'Log what happens; twice for more'
complete -c mariana -n "__fish_mariana_using_subcommand bench" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c mariana -n "__fish_mariana_using_subcommand check" -l json -d 'Print a JSON object for each mistake, one a line: file, line, column, end, severity, message, hint'
complete -c mariana -n "__fish_mariana_using_subcommand check" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand tape" -l glsl -d 'Print the distance as GLSL instead'
complete -c mariana -n "__fish_mariana_using_subcommand tape" -l dot -d 'Print the expression graph in Graphviz\'s language instead'
complete -c mariana -n "__fish_mariana_using_subcommand tape" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand eval" -l at -d 'A point at which to evaluate; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand eval" -l points -d 'A file with one point per line: x,y,z; \'-\' is standard input' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand eval" -l set -d 'Hold an input at a value, such as "volume.x=0.3", "band(3)=0.5" or a param of the scene; can be given more than once' -r
complete -c mariana -n "__fish_mariana_using_subcommand eval" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand show" -l scene -d 'A scene among which to choose; can be given more than once [default: all shipped scenes]' -r
complete -c mariana -n "__fish_mariana_using_subcommand show" -s o -l output -d 'The show file to write; \'-\' is standard output' -r -F
complete -c mariana -n "__fish_mariana_using_subcommand show" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand scenes" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand devices" -l json -d 'Print JSON instead of text'
complete -c mariana -n "__fish_mariana_using_subcommand devices" -s h -l help -d 'Print help'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "still" -d 'Render one moment of a song to a PNG, JPEG or WebP, without a window or a sound card'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "video" -d 'Render a stretch of a song to a video (needs ffmpeg) or to numbered stills'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "analyze" -d 'Print the features of a song, one line for each frame'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "bench" -d 'Measure frame times and distance evaluations, without a window'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "check" -d 'Check scenes: print every mistake with its place, or what the scene costs'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "tape" -d 'Print the tape of a scene\'s distance: the clauses that an interpreter runs'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "eval" -d 'Evaluate a scene\'s distance at points, one number per line'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "show" -d 'Write down the show that follows a song, as a file to edit'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "scenes" -d 'List the shipped scenes, with what each shows'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "devices" -d 'List the sound systems, inputs and outputs with what they support'
complete -c mariana -n "__fish_mariana_using_subcommand help; and not __fish_seen_subcommand_from still video analyze bench check tape eval show scenes devices help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
