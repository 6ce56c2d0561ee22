_mariana() {
    local i cur prev opts cmd
    COMPREPLY=()
    if [[ "${BASH_VERSINFO[0]}" -ge 4 ]]; then
        cur="$2"
    else
        cur="${COMP_WORDS[COMP_CWORD]}"
    fi
    prev="$3"
    cmd=""
    opts=""

    for i in "${COMP_WORDS[@]:0:COMP_CWORD}"
    do
        case "${cmd},${i}" in
            ",$1")
                cmd="mariana"
                ;;
            mariana,analyze)
                cmd="mariana__subcmd__analyze"
                ;;
            mariana,bench)
                cmd="mariana__subcmd__bench"
                ;;
            mariana,check)
                cmd="mariana__subcmd__check"
                ;;
            mariana,devices)
                cmd="mariana__subcmd__devices"
                ;;
            mariana,eval)
                cmd="mariana__subcmd__eval"
                ;;
            mariana,export)
                cmd="mariana__subcmd__export"
                ;;
            mariana,format)
                cmd="mariana__subcmd__format"
                ;;
            mariana,help)
                cmd="mariana__subcmd__help"
                ;;
            mariana,import)
                cmd="mariana__subcmd__import"
                ;;
            mariana,lsp)
                cmd="mariana__subcmd__lsp"
                ;;
            mariana,mesh)
                cmd="mariana__subcmd__mesh"
                ;;
            mariana,page)
                cmd="mariana__subcmd__page"
                ;;
            mariana,scenes)
                cmd="mariana__subcmd__scenes"
                ;;
            mariana,show)
                cmd="mariana__subcmd__show"
                ;;
            mariana,still)
                cmd="mariana__subcmd__still"
                ;;
            mariana,tape)
                cmd="mariana__subcmd__tape"
                ;;
            mariana,video)
                cmd="mariana__subcmd__video"
                ;;
            mariana__subcmd__help,analyze)
                cmd="mariana__subcmd__help__subcmd__analyze"
                ;;
            mariana__subcmd__help,bench)
                cmd="mariana__subcmd__help__subcmd__bench"
                ;;
            mariana__subcmd__help,check)
                cmd="mariana__subcmd__help__subcmd__check"
                ;;
            mariana__subcmd__help,devices)
                cmd="mariana__subcmd__help__subcmd__devices"
                ;;
            mariana__subcmd__help,eval)
                cmd="mariana__subcmd__help__subcmd__eval"
                ;;
            mariana__subcmd__help,export)
                cmd="mariana__subcmd__help__subcmd__export"
                ;;
            mariana__subcmd__help,format)
                cmd="mariana__subcmd__help__subcmd__format"
                ;;
            mariana__subcmd__help,help)
                cmd="mariana__subcmd__help__subcmd__help"
                ;;
            mariana__subcmd__help,import)
                cmd="mariana__subcmd__help__subcmd__import"
                ;;
            mariana__subcmd__help,lsp)
                cmd="mariana__subcmd__help__subcmd__lsp"
                ;;
            mariana__subcmd__help,mesh)
                cmd="mariana__subcmd__help__subcmd__mesh"
                ;;
            mariana__subcmd__help,page)
                cmd="mariana__subcmd__help__subcmd__page"
                ;;
            mariana__subcmd__help,scenes)
                cmd="mariana__subcmd__help__subcmd__scenes"
                ;;
            mariana__subcmd__help,show)
                cmd="mariana__subcmd__help__subcmd__show"
                ;;
            mariana__subcmd__help,still)
                cmd="mariana__subcmd__help__subcmd__still"
                ;;
            mariana__subcmd__help,tape)
                cmd="mariana__subcmd__help__subcmd__tape"
                ;;
            mariana__subcmd__help,video)
                cmd="mariana__subcmd__help__subcmd__video"
                ;;
            *)
                ;;
        esac
    done

    case "${cmd}" in
        mariana)
            opts="-v -h -V --mic --system --shuffle --repeat --device --silent --once --volume --latency --fps-cap --fade --fullscreen --clean --size --show --osc --osc-send --osc-rate --midi --remote --new --new-window --prepare-ahead --program-cache --gl-info --quality --flash-limiter --brightness --blackout-fade --flip --crop --corners --output --wallpaper --send --send-size --send-fps --scene --view --projection --stereo --eye-distance --dome-tilt --sdf --regions --tone-map --gain --shaders --verbose --help --version still video analyze bench check format lsp tape eval import export show mesh page scenes devices help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 1 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --repeat)
                    COMPREPLY=($(compgen -W "all one off" -- "${cur}"))
                    return 0
                    ;;
                --device)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --volume)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --latency)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --fps-cap)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --fade)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --size)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --show)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --osc)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --osc-send)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --osc-rate)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --midi)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --remote)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --prepare-ahead)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --program-cache)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --quality)
                    COMPREPLY=($(compgen -W "auto low medium high best" -- "${cur}"))
                    return 0
                    ;;
                --flash-limiter)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --brightness)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --blackout-fade)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --flip)
                    COMPREPLY=($(compgen -W "off horizontal vertical both" -- "${cur}"))
                    return 0
                    ;;
                --crop)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --corners)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --send)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --send-size)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --send-fps)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --scene)
                    COMPREPLY=($(compgen -f -W "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world" -- "${cur}"))
                    return 0
                    ;;
                --view)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --projection)
                    COMPREPLY=($(compgen -W "flat 360 dome vr180" -- "${cur}"))
                    return 0
                    ;;
                --stereo)
                    COMPREPLY=($(compgen -W "none side-by-side over-under" -- "${cur}"))
                    return 0
                    ;;
                --eye-distance)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --dome-tilt)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --sdf)
                    COMPREPLY=($(compgen -W "interpreted compiled auto" -- "${cur}"))
                    return 0
                    ;;
                --regions)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --tone-map)
                    COMPREPLY=($(compgen -W "scene agx aces reinhard none" -- "${cur}"))
                    return 0
                    ;;
                --gain)
                    COMPREPLY=($(compgen -W "auto off" -- "${cur}"))
                    return 0
                    ;;
                --shaders)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__analyze)
            opts="-h --structure --plot --song --json --gain --fps --start --duration --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --plot)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --gain)
                    COMPREPLY=($(compgen -W "auto off" -- "${cur}"))
                    return 0
                    ;;
                --fps)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --start)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --duration)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__bench)
            opts="-v -h --at --size --frames --all --only --edges --json --scene --sdf --regions --tone-map --gain --shaders --verbose --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --at)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --size)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --frames)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --only)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --scene)
                    COMPREPLY=($(compgen -f -W "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world" -- "${cur}"))
                    return 0
                    ;;
                --sdf)
                    COMPREPLY=($(compgen -W "interpreted compiled auto" -- "${cur}"))
                    return 0
                    ;;
                --regions)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --tone-map)
                    COMPREPLY=($(compgen -W "scene agx aces reinhard none" -- "${cur}"))
                    return 0
                    ;;
                --gain)
                    COMPREPLY=($(compgen -W "auto off" -- "${cur}"))
                    return 0
                    ;;
                --shaders)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__check)
            opts="-h --json --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__devices)
            opts="-h --json --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__eval)
            opts="-h --at --points --set --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --at)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --points)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --set)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__export)
            opts="-o -h --glsl --main-image --output --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                -o)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__format)
            opts="-h --check --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help)
            opts="still video analyze bench check format lsp tape eval import export show mesh page scenes devices help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__analyze)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__bench)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__check)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__devices)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__eval)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__export)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__format)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__help)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__import)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__lsp)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__mesh)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__page)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__scenes)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__show)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__still)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__tape)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__help__subcmd__video)
            opts=""
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 3 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__import)
            opts="-o -h --output --as --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                -o)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --as)
                    COMPREPLY=($(compgen -W "picture shape" -- "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__lsp)
            opts="-h --stdio --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__mesh)
            opts="-o -v -h --at --detail --scene --set --output --sdf --regions --tone-map --gain --shaders --verbose --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --at)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --detail)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --scene)
                    COMPREPLY=($(compgen -f -W "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world" -- "${cur}"))
                    return 0
                    ;;
                --set)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                -o)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --sdf)
                    COMPREPLY=($(compgen -W "interpreted compiled auto" -- "${cur}"))
                    return 0
                    ;;
                --regions)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --tone-map)
                    COMPREPLY=($(compgen -W "scene agx aces reinhard none" -- "${cur}"))
                    return 0
                    ;;
                --gain)
                    COMPREPLY=($(compgen -W "auto off" -- "${cur}"))
                    return 0
                    ;;
                --shaders)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__page)
            opts="-o -v -h --output --template --scene --show --loop --embed --sdf --regions --tone-map --gain --shaders --verbose --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                -o)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --template)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --scene)
                    COMPREPLY=($(compgen -f -W "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world" -- "${cur}"))
                    return 0
                    ;;
                --show)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --sdf)
                    COMPREPLY=($(compgen -W "interpreted compiled auto" -- "${cur}"))
                    return 0
                    ;;
                --regions)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --tone-map)
                    COMPREPLY=($(compgen -W "scene agx aces reinhard none" -- "${cur}"))
                    return 0
                    ;;
                --gain)
                    COMPREPLY=($(compgen -W "auto off" -- "${cur}"))
                    return 0
                    ;;
                --shaders)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__scenes)
            opts="-h --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__show)
            opts="-o -h --scene --output --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --scene)
                    COMPREPLY=($(compgen -f -W "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world" -- "${cur}"))
                    return 0
                    ;;
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                -o)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__still)
            opts="-o -v -h --at --for --size --projection --stereo --eye-distance --dome-tilt --shutter --shutter-frames --light --samples --noise --no-filter --output --scene --alpha --show --into --blend --ray --controlled --set --view --sdf --regions --tone-map --gain --shaders --verbose --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --at)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --for)
                    COMPREPLY=($(compgen -W "youtube 4k shorts tiktok reel story square loop" -- "${cur}"))
                    return 0
                    ;;
                --size)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --projection)
                    COMPREPLY=($(compgen -W "flat 360 dome vr180" -- "${cur}"))
                    return 0
                    ;;
                --stereo)
                    COMPREPLY=($(compgen -W "none side-by-side over-under" -- "${cur}"))
                    return 0
                    ;;
                --eye-distance)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --dome-tilt)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --shutter)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --shutter-frames)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --light)
                    COMPREPLY=($(compgen -W "raster path" -- "${cur}"))
                    return 0
                    ;;
                --samples)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --noise)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                -o)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --scene)
                    COMPREPLY=($(compgen -f -W "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world" -- "${cur}"))
                    return 0
                    ;;
                --show)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --into)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --blend)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --ray)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --set)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --view)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --sdf)
                    COMPREPLY=($(compgen -W "interpreted compiled auto" -- "${cur}"))
                    return 0
                    ;;
                --regions)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --tone-map)
                    COMPREPLY=($(compgen -W "scene agx aces reinhard none" -- "${cur}"))
                    return 0
                    ;;
                --gain)
                    COMPREPLY=($(compgen -W "auto off" -- "${cur}"))
                    return 0
                    ;;
                --shaders)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__tape)
            opts="-h --glsl --dot --at --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --at)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
        mariana__subcmd__video)
            opts="-o -q -v -h --for --start --duration --fps --size --projection --stereo --eye-distance --dome-tilt --shutter --shutter-frames --light --samples --noise --no-filter --codec --quality --draft --title-card --lyrics --flash-limiter --scene --alpha --show --set --output --part --join --quiet --controlled --view --sdf --regions --tone-map --gain --shaders --verbose --help"
            if [[ ${cur} == -* || ${COMP_CWORD} -eq 2 ]] ; then
                COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
                return 0
            fi
            case "${prev}" in
                --for)
                    COMPREPLY=($(compgen -W "youtube 4k shorts tiktok reel story square loop" -- "${cur}"))
                    return 0
                    ;;
                --start)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --duration)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --fps)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --size)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --projection)
                    COMPREPLY=($(compgen -W "flat 360 dome vr180" -- "${cur}"))
                    return 0
                    ;;
                --stereo)
                    COMPREPLY=($(compgen -W "none side-by-side over-under" -- "${cur}"))
                    return 0
                    ;;
                --eye-distance)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --dome-tilt)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --shutter)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --shutter-frames)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --light)
                    COMPREPLY=($(compgen -W "raster path" -- "${cur}"))
                    return 0
                    ;;
                --samples)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --noise)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --codec)
                    COMPREPLY=($(compgen -W "h264 h265 vp9 av1" -- "${cur}"))
                    return 0
                    ;;
                --quality)
                    COMPREPLY=($(compgen -W "low medium high best" -- "${cur}"))
                    return 0
                    ;;
                --lyrics)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --flash-limiter)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --scene)
                    COMPREPLY=($(compgen -f -W "barth cathedral city clockwork cloud_sea fireflies first_steps forest glass_organ gyroid heart ink kaleidoscope lattice lava_lamp letters library mandelbulb marbling metaballs moonrise nave orb quadric rain reef speakers spiral terrain tunnel village wave_tank wax_world" -- "${cur}"))
                    return 0
                    ;;
                --show)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --set)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --output)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                -o)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --part)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --join)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --view)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                --sdf)
                    COMPREPLY=($(compgen -W "interpreted compiled auto" -- "${cur}"))
                    return 0
                    ;;
                --regions)
                    COMPREPLY=($(compgen -W "on off" -- "${cur}"))
                    return 0
                    ;;
                --tone-map)
                    COMPREPLY=($(compgen -W "scene agx aces reinhard none" -- "${cur}"))
                    return 0
                    ;;
                --gain)
                    COMPREPLY=($(compgen -W "auto off" -- "${cur}"))
                    return 0
                    ;;
                --shaders)
                    COMPREPLY=($(compgen -f "${cur}"))
                    return 0
                    ;;
                *)
                    COMPREPLY=()
                    ;;
            esac
            COMPREPLY=( $(compgen -W "${opts}" -- "${cur}") )
            return 0
            ;;
    esac
}

if [[ "${BASH_VERSINFO[0]}" -eq 4 && "${BASH_VERSINFO[1]}" -ge 4 || "${BASH_VERSINFO[0]}" -gt 4 ]]; then
    complete -F _mariana -o nosort -o bashdefault -o default mariana
else
    complete -F _mariana -o bashdefault -o default mariana
fi
