BEGIN PGM {{ name }} MM
; {{ title }}
{%- for comment in header %}
; {{ comment }}
{%- endfor %}
{%- for line in lines %}
{%- match line %}
{%- when Line::Comment with (text) %}
; {{ text }}
{%- when Line::Chord with (words) %}
{{ words }}
{%- when Line::Block with (_n, words) %}
{{ words }}
{%- when Line::Cutting with (_n) %}
{%- when Line::Dwell with (_n, seconds) %}
CYCL DEF 9.0 DWELL TIME
CYCL DEF 9.1 DWELL {{ seconds.decimal() }}
{%- when Line::Stop with (_n, text) %}
; {{ text }}
STOP
{%- when Line::End with (_n) %}
M30
{%- when Line::Call with (_n, _program) %}
{%- when Line::Subprogram with (_program, _text) %}
{%- when Line::Return with (_n) %}
{%- endmatch %}
{%- endfor %}
END PGM {{ name }} MM
